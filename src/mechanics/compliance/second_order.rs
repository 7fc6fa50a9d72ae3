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
    let mut bands = vec![[0.0; WIDTH]; count];
    // Integrals of negative modes are those of positive ones.
    let mut add = |one: isize, other: isize, value: f64| {
        let (one, other) = (one.unsigned_abs(), other.unsigned_abs());
        if let Some(bands) = bands.get_mut(one.max(other)) {
            bands[one.abs_diff(other)] += value;
        }
    };
    for (n, ((normal, along), shear)) in normal.iter().zip(along).zip(shear).enumerate().take(count) {
        let (m, n) = (n as f64, n as isize);
        let moved = [(-2, (1.0 + m) / 8.0), (-1, -m / 4.0), (0, -0.25), (1, m / 4.0), (2, (1.0 - m) / 8.0)];
        for (away, share) in moved {
            add(n, n + away, 2.0 * normal * share);
        }
        for (away, share) in [(-2, -0.25), (-1, 0.25), (1, -0.25), (2, 0.25)] {
            add(n, n + away, 2.0 * along * share);
        }
        add(n - 1, n - 1, 0.25 * shear);
        add(n - 1, n + 1, -0.5 * shear);
        add(n + 1, n + 1, 0.25 * shear);
    }
    bands
}
