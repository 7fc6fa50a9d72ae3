//! Small whole numbers of a Parquet column, row by row: levels, and places in a dictionary. Runs of one number and groups of packed
//! ones take turns (Parquet's encoding RLE).

/// Numbers with how often each follows itself.
#[derive(Default)]
pub struct Runs(Vec<(u32, usize)>);

/// Numbers that are packed together.
const GROUP: usize = 8;

impl Runs {
    pub fn push(&mut self, number: u32, times: usize) {
        match self.0.last_mut() {
            Some((last, count)) if *last == number => *count += times,
            _ if times > 0 => self.0.push((number, times)),
            _ => {}
        }
    }

    /// All numbers, one by one.
    pub fn numbers(&self) -> impl Iterator<Item = u32> {
        self.0.iter().flat_map(|(number, times)| std::iter::repeat_n(*number, *times))
    }

    /// Appends them, each of so many bits (at most 32).
    pub fn encode(&self, bits: u32, bytes: &mut Vec<u8>) {
        let mut packed: Vec<u32> = Vec::new();
        for &(number, times) in &self.0 {
            // Groups are whole, but for the last.
            let missing = packed.len().next_multiple_of(GROUP) - packed.len();
            let to_group = missing.min(times);
            packed.extend(std::iter::repeat_n(number, to_group));
            let left = times - to_group;
            if left < GROUP {
                packed.extend(std::iter::repeat_n(number, left));
            } else {
                pack(&mut packed, bits, bytes);
                put_varint((left as u64) << 1, bytes);
                bytes.extend(&number.to_le_bytes()[..bits.div_ceil(8) as usize]);
            }
        }
        pack(&mut packed, bits, bytes);
    }
}

/// Appends numbers in groups, the last one filled with zeros, and takes them away.
fn pack(numbers: &mut Vec<u32>, bits: u32, bytes: &mut Vec<u8>) {
    if numbers.is_empty() {
        return;
    }
    numbers.resize(numbers.len().next_multiple_of(GROUP), 0);
    put_varint((numbers.len() / GROUP) as u64 * 2 + 1, bytes);
    let (mut waiting, mut count) = (0_u64, 0);
    for number in numbers.drain(..) {
        waiting |= u64::from(number) << count;
        count += bits;
        while count >= 8 {
            bytes.push(waiting as u8);
            waiting >>= 8;
            count -= 8;
        }
    }
}

/// Seven bits a byte, the lowest first.
fn put_varint(mut number: u64, bytes: &mut Vec<u8>) {
    while number > 0x7f {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

/// Bits of the numbers from 0 to the greatest, at least one.
pub fn bits_of(greatest: u32) -> u32 {
    (u32::BITS - greatest.leading_zeros()).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the format describes it, for so many numbers of so many bits.
    fn decoded(bytes: &[u8], bits: u32, count: usize) -> Vec<u32> {
        let (mut numbers, mut at) = (Vec::new(), 0);
        while numbers.len() < count {
            let (mut header, mut shift) = (0_u64, 0);
            loop {
                let byte = bytes[at];
                at += 1;
                header |= u64::from(byte & 0x7f) << shift;
                shift += 7;
                if byte < 0x80 {
                    break;
                }
            }
            if header % 2 == 0 {
                let length = bits.div_ceil(8) as usize;
                let number =
                    bytes[at..at + length].iter().rev().fold(0, |sum, byte| sum << 8 | u32::from(*byte));
                at += length;
                numbers.extend(std::iter::repeat_n(number, (header / 2) as usize));
            } else {
                let length = (header / 2) as usize * bits as usize;
                let bit = |place: usize| u32::from(bytes[at + place / 8] >> (place % 8) & 1);
                for number in 0..(header / 2) as usize * GROUP {
                    let from = number * bits as usize;
                    numbers.push((0..bits as usize).map(|i| bit(from + i) << i).sum());
                }
                at += length;
            }
        }
        assert_eq!(at, bytes.len());
        numbers.truncate(count);
        numbers
    }

    #[test]
    fn runs_are_read_as_they_were_pushed() {
        let mut seed = 1_u64;
        let mut draw = |below: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % below
        };
        let mut compared = 0;
        for bits in [1, 2, 3, 7, 8, 9, 13, 16, 17, 24, 31, 32] {
            for longest in [1, 2, 7, 8, 9, 20, 300] {
                let mut runs = Runs::default();
                let mut expected = Vec::new();
                for _ in 0..draw(60) {
                    let (number, times) = (draw(1 << bits) as u32, draw(longest + 1) as usize);
                    runs.push(number, times);
                    expected.extend(std::iter::repeat_n(number, times));
                }
                let mut bytes = Vec::new();
                runs.encode(bits, &mut bytes);
                assert!(runs.numbers().eq(expected.iter().copied()));
                assert_eq!(decoded(&bytes, bits, expected.len()), expected, "{bits} bits, up to {longest}");
                compared += expected.len();
            }
        }
        assert!(compared > 10_000);
    }

    #[test]
    fn bits_are_as_few_as_hold_the_greatest() {
        assert_eq!([0, 1, 2, 3, 4, 255, 256, u32::MAX].map(bits_of), [1, 1, 2, 2, 3, 8, 9, 32]);
    }
}
