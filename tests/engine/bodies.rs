//! What a library of bodies keeps.

use jointsweep::internals::engine::bodies::{BodyLibrary, KEPT_PLANS};
use jointsweep::internals::engine::body_request::{BodyRequest, Fidelity};
use jointsweep::internals::mechanics::body::Body;
use jointsweep::internals::mechanics::material::Idealization;

/// Bodies of ever new topologies and near fields take no more memory the more there are, and each is answered.
#[test]
fn what_is_kept_is_bounded() {
    let request = |index: usize| BodyRequest {
        body: Body::concentric(
            (0.05 + 0.05 * index as f64).exp(),
            if index.is_multiple_of(2) { 0.3 } else { -0.3 },
            Idealization::PlaneStress,
        ),
        fidelity: Fidelity::Mesh { level: index % 4 },
    };
    let requests: Vec<BodyRequest> = (0..240).map(request).collect();
    let mut library = BodyLibrary::default();
    for batch in requests.chunks(24) {
        library.solve(batch);
        for request in batch {
            let (_, works) = library.solved(request).compliance.boundary.ring_modes().unwrap();
            assert!(!works.is_empty() && works.iter().all(|work| work.is_finite()));
        }
        let [near_fields, plans] = library.kept_bytes();
        assert!(plans > 0 && plans <= KEPT_PLANS && near_fields > 0 && near_fields <= 64 << 20);
    }
}
