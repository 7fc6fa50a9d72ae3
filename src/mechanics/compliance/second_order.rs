//! What the outlines of a joint add to the compliance of its pin to second order in the clearance.
//!
//! The pressure p meets the pin at h eta^2 from where `contact::outlines` puts it, h = sin(theta) (1 - cos(theta))/2, and its tilt is
//! eta sin(theta) + eta^2 [sin(theta) - sin(2 theta)/2], eta = dR/R2. Of the integrals P_n of p cos(n theta) and T_n of
//! p sin(theta) sin(n theta) the work of a pin with the amplitudes lambda_n (normal), tau_n (along the ring, under normal pressure) and
//! sigma_n (along the ring, under what pushes along it) has, of the order eta^2, (2/pi) times the sum over n of
//!
//! ```text
//!   2 lambda_n P_n dP_n + 2 tau_n P_n dT_n + sigma_n T_n^2,
//!   dP_n = integral of p [-sin^2(theta) cos(n theta)/2 - n h sin(n theta)],    T_n = (P_n-1 - P_n+1)/2,
//!   dT_n = integral of p [sin(theta) - sin(2 theta)] sin(n theta)/2,
//! ```
//!
//! all of them sums of integrals at most two modes away.

/// Of mode n: what is times P_n^2, P_n P_n-1 and P_n P_n-2 in the work.
pub type Bands = [f64; WIDTH];

/// How many numbers a mode has.
pub const WIDTH: usize = 3;

/// From lambda_n (half of it for n = 0), tau_n and sigma_n, n = 0, 1, ..., the first `count` modes, the rest being zero.
pub fn bands([normal, along, shear]: [&[f64]; 3], count: usize) -> Vec<Bands> {
    // Modes reach two beyond their own.
    let mut bands = vec![[0.0; WIDTH]; count + 2];
    for (n, ((normal, along), shear)) in normal.iter().zip(along).zip(shear).enumerate().take(count) {
        let m = n as f64;
        let (normal, along) = (2.0 * normal, 2.0 * along);
        // With modes n - 2, n - 1, n, n + 1, n + 2.
        let shares = [
            normal * (1.0 + m) / 8.0 - 0.25 * along,
            0.25 * (along - normal * m),
            -0.25 * normal,
            0.25 * (normal * m - along),
            normal * (1.0 - m) / 8.0 + 0.25 * along,
        ];
        let of_tilt = 0.25 * shear;
        if n < 2 {
            // Integrals of negative modes are those of positive ones.
            let mut add =
                |one: usize, other: usize, value: f64| bands[one.max(other)][one.abs_diff(other)] += value;
            for (away, share) in shares.into_iter().enumerate() {
                add(n, (n + away).abs_diff(2), share);
            }
            let (before, behind) = (n.abs_diff(1), n + 1);
            add(before, before, of_tilt);
            add(before, behind, -2.0 * of_tilt);
            add(behind, behind, of_tilt);
        } else if let Some([before, own, behind, beyond]) = bands[n - 1..].first_chunk_mut() {
            for (band, share) in own.iter_mut().rev().zip(shares) {
                *band += share;
            }
            behind[1] += shares[3];
            beyond[2] += shares[4];
            before[0] += of_tilt;
            behind[0] += of_tilt;
            behind[2] -= 2.0 * of_tilt;
        }
    }
    bands.truncate(count);
    bands
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of forces at some places, against the sums above.
    #[test]
    fn bands_are_the_work() {
        // All but the last two modes, which others reach, have amplitudes.
        const COUNT: usize = 12;
        let amplitudes = |seed: usize| -> Vec<f64> {
            let amplitude = |n: usize| ((7 * n + seed) as f64).sin() * f64::from(u8::from(n + 2 < COUNT));
            (0..COUNT).map(amplitude).collect()
        };
        let [normal, along, shear] = [1, 2, 3].map(amplitudes);
        for count in 1..=COUNT {
            let own = bands([&normal, &along, &shear], count);
            // Fewer are the first of more, but for what modes beyond them add.
            let all = bands([&normal, &along, &shear], COUNT);
            assert_eq!(own.len(), count);
            assert_eq!(own[..count.saturating_sub(1)], all[..count.saturating_sub(1)], "{count}");
        }
        let forces = [(0.2, 1.0), (0.7, -0.4), (1.1, 2.0), (2.3, 0.6)];
        let integral = |of: &dyn Fn(f64) -> f64| forces.iter().map(|(angle, force)| force * of(*angle)).sum();
        let mut expected = 0.0;
        for n in 0..COUNT {
            let m = n as f64;
            let p: f64 = integral(&|angle| (m * angle).cos());
            let dp: f64 = integral(&|angle| {
                let (sine, height) = (angle.sin(), 0.5 * angle.sin() * (1.0 - angle.cos()));
                -0.5 * sine * sine * (m * angle).cos() - m * height * (m * angle).sin()
            });
            let t: f64 = integral(&|angle| angle.sin() * (m * angle).sin());
            let dt: f64 = integral(&|angle| 0.5 * (angle.sin() - (2.0 * angle).sin()) * (m * angle).sin());
            expected += 2.0 * normal[n] * p * dp + 2.0 * along[n] * p * dt + shear[n] * t * t;
        }
        let modes: Vec<f64> = (0..COUNT).map(|n| integral(&|angle| (n as f64 * angle).cos())).collect();
        let mut found = 0.0;
        for (n, own) in bands([&normal, &along, &shear], COUNT).iter().enumerate() {
            for (before, band) in own.iter().enumerate().take(n + 1) {
                found += band * modes[n] * modes[n - before];
            }
        }
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}
