//! Bodies to be solved by topology, with the near fields they need, so many at a time.

use foldhash::HashMap;
use rayon::prelude::*;

use crate::engine::body_request::{Around, BodyHandle, BodyRequest, Group, Meshed, RingAngles, TopologyKey};
use crate::engine::hashed::Hashed;
use crate::mechanics::compliance::near_field::{InCommon, NearFieldClass};

/// So many requests, or designs, at least are worth a thread where only little is done for each.
pub const MANY: usize = 64;

/// No more bodies are solved at a time than need so many near fields.
const PORTION: usize = 1000;

/// Bodies that are solved at a time, with the near fields they need.
#[derive(Default)]
pub struct Portion {
    pub groups: Vec<Group>,
    /// Those that a device was given, which are not among `groups`.
    pub on_device: Vec<Group>,
    pub near_fields: Vec<NearFieldClass>,
}

/// The requests by topology, in portions each of which ends where it needs more than `PORTION` near fields.
pub fn portions(requests: Vec<(BodyHandle, &BodyRequest)>, common: &InCommon) -> Vec<Portion> {
    let keys = requests.par_iter().with_min_len(MANY);
    let key = |angles: &mut RingAngles, (_, request): &(BodyHandle, &BodyRequest)| {
        Hashed::new(TopologyKey::after(angles, request))
    };
    let keys: Vec<_> = keys.map_init(RingAngles::default, key).collect();
    let mut groups: HashMap<Hashed<TopologyKey>, Vec<(BodyHandle, &BodyRequest)>> = HashMap::default();
    for (request, key) in requests.into_iter().zip(keys) {
        groups.entry(key).or_default().push(request);
    }
    let groups: Vec<_> =
        groups.into_par_iter().map(|(key, bodies)| OfTopology::new(key.key, bodies, common)).collect();
    let mut portions = vec![Portion::default()];
    let mut places: HashMap<NearFieldClass, u32> = HashMap::default();
    for OfTopology { key, mut bodies, classes } in groups {
        let mut portion = portions.len() - 1;
        if portions[portion].near_fields.len() > PORTION {
            portions.push(Portion::default());
            places.clear();
            portion += 1;
        }
        let Portion { groups, near_fields, .. } = &mut portions[portion];
        let of_class = |class: &NearFieldClass| {
            *places.entry(*class).or_insert_with(|| {
                near_fields.push(*class);
                near_fields.len() as u32 - 1
            })
        };
        let of_classes: Vec<u32> = classes.iter().map(of_class).collect();
        for Around { classes, .. } in bodies.iter_mut().filter_map(|body| body.around.as_mut()) {
            *classes = classes.map(|own| of_classes[own as usize]);
        }
        groups.push((key, bodies));
    }
    portions
}

/// Bodies of one topology, with the near fields they need.
struct OfTopology {
    key: TopologyKey,
    bodies: Vec<Meshed>,
    classes: Vec<NearFieldClass>,
}

impl OfTopology {
    fn new(key: TopologyKey, requests: Vec<(BodyHandle, &BodyRequest)>, common: &InCommon) -> OfTopology {
        let meshed = |&(handle, request): &(BodyHandle, &BodyRequest)| Meshed {
            handle,
            body: request.body.clone(),
            around: None,
        };
        let mut bodies: Vec<Meshed> = requests.iter().map(meshed).collect();
        let mut classes: Vec<NearFieldClass> = Vec::new();
        // Lined bodies have references of their own.
        if !key.class.is_lined() {
            let own = requests.iter().map(|(_, request)| &request.body);
            let around = NearFieldClass::around_each(own, key.class, common);
            let mut place = |class: NearFieldClass| {
                // Of bodies of one topology there are few.
                let known = classes
                    .iter()
                    .position(|known| (known.range, known.growth) == (class.range, class.growth));
                known.unwrap_or_else(|| {
                    classes.push(class);
                    classes.len() - 1
                }) as u32
            };
            for (body, (around, between)) in bodies.iter_mut().zip(around) {
                body.around = Some(Around { classes: around.map(&mut place), between });
            }
        }
        OfTopology { key, bodies, classes }
    }
}
