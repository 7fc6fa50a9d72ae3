//! Whole numbers of a Parquet column in few bits. Levels and places in a dictionary: runs of one number and groups of packed ones take turns
//! (Parquet's encoding RLE). Others by their differences.

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
    put_bits(numbers.drain(..).map(u64::from), bits, bytes);
}

/// Appends numbers, as many as a multiple of eight, of so many bits each.
fn put_bits(numbers: impl Iterator<Item = u64>, bits: u32, bytes: &mut Vec<u8>) {
    let (mut waiting, mut count) = (0_u128, 0);
    for number in numbers {
        waiting |= u128::from(number) << count;
        count += bits;
        while count >= 8 {
            bytes.push(waiting as u8);
            waiting >>= 8;
            count -= 8;
        }
    }
}

/// Differences that are packed together, in so many parts, each of as many bits as it needs.
const BLOCK: usize = 128;
const PARTS: usize = 4;

/// Appends numbers by their differences (Parquet's encoding DELTA_BINARY_PACKED).
pub fn put_differences(numbers: &[i64], bytes: &mut Vec<u8>) {
    put_varint(BLOCK as u64, bytes);
    put_varint(PARTS as u64, bytes);
    put_varint(numbers.len() as u64, bytes);
    put_varint(zigzag(numbers.first().copied().unwrap_or(0)), bytes);
    let differences: Vec<i64> = numbers.windows(2).map(|pair| pair[1].wrapping_sub(pair[0])).collect();
    for block in differences.chunks(BLOCK) {
        let least = block.iter().copied().min().unwrap_or(0);
        put_varint(zigzag(least), bytes);
        let above = |difference: &i64| difference.wrapping_sub(least) as u64;
        let parts = || block.chunks(BLOCK / PARTS);
        let bits_of_part =
            |part: &[i64]| u64::BITS - part.iter().map(above).max().unwrap_or(0).leading_zeros();
        let widths = parts().map(|part| bits_of_part(part) as u8).chain(std::iter::repeat(0));
        bytes.extend(widths.take(PARTS));
        for part in parts() {
            let filled = part.iter().map(above).chain(std::iter::repeat(0)).take(BLOCK / PARTS);
            put_bits(filled, bits_of_part(part), bytes);
        }
    }
}

/// Of numbers near zero small ones, whatever their sign.
fn zigzag(number: i64) -> u64 {
    (number << 1 ^ number >> 63) as u64
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

    fn read_varint(bytes: &[u8], at: &mut usize) -> u64 {
        let (mut number, mut shift) = (0, 0);
        loop {
            let byte = bytes[*at];
            *at += 1;
            number |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if byte < 0x80 {
                return number;
            }
        }
    }

    /// As the format describes it, for so many numbers of so many bits.
    fn decoded(bytes: &[u8], bits: u32, count: usize) -> Vec<u32> {
        let (mut numbers, mut at) = (Vec::new(), 0);
        while numbers.len() < count {
            let header = read_varint(bytes, &mut at);
            if header.is_multiple_of(2) {
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

    /// As the format describes it.
    fn summed_up(bytes: &[u8]) -> Vec<i64> {
        let mut at = 0;
        let signed = |number: u64| (number >> 1) as i64 ^ -((number & 1) as i64);
        let [block, parts, count] = [(); 3].map(|()| read_varint(bytes, &mut at) as usize);
        let mut numbers = vec![signed(read_varint(bytes, &mut at))];
        while numbers.len() < count {
            let least = signed(read_varint(bytes, &mut at));
            let widths = &bytes[at..at + parts];
            at += parts;
            for width in widths {
                if numbers.len() >= count {
                    continue;
                }
                let packed = &bytes[at..][..block / parts * usize::from(*width) / 8];
                at += packed.len();
                let bit = |place: usize| u64::from(packed[place / 8] >> (place % 8) & 1);
                for number in 0..block / parts {
                    let above = (0..usize::from(*width))
                        .map(|i| bit(number * usize::from(*width) + i) << i)
                        .sum::<u64>();
                    let last = numbers[numbers.len() - 1];
                    numbers.push(last.wrapping_add(least).wrapping_add(above as i64));
                }
            }
        }
        assert_eq!(at, bytes.len());
        numbers.truncate(count);
        numbers
    }

    #[test]
    fn differences_sum_up_to_the_numbers() {
        let extremes = [i64::MIN, i64::MAX, 0, -1, 1, i64::MAX, i64::MIN];
        let mut lists = vec![extremes.to_vec(), vec![7], (0..1000).map(|i| i / 10).collect()];
        lists.extend((1..300).map(|count| (0..count).map(|i| i * i * (i % 3 - 1) * count).collect()));
        for list in &lists {
            let mut bytes = Vec::new();
            put_differences(list, &mut bytes);
            assert_eq!(summed_up(&bytes), *list);
        }
        let mut bytes = Vec::new();
        put_differences(&(0..1_000_000).collect::<Vec<_>>(), &mut bytes);
        assert!(bytes.len() < 50_000, "{} bytes", bytes.len());
    }

    #[test]
    fn bits_are_as_few_as_hold_the_greatest() {
        assert_eq!([0, 1, 2, 3, 4, 255, 256, u32::MAX].map(bits_of), [1, 1, 2, 2, 3, 8, 9, 32]);
    }
}
