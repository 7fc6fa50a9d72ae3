//! The kernels without a device: every variant is parsed and validated, and what both sides share is compared.

use std::mem::offset_of;
use std::path::Path;

use jointsweep::internals::engine::backend::drawn::DrawSettings;
use jointsweep::internals::engine::backend::gpu::batch::{KernelFacts, OnChip};
use jointsweep::internals::engine::backend::gpu::front::{EliminateParameters, Front};
use jointsweep::internals::engine::backend::gpu::joint_load::Placed;
use jointsweep::internals::engine::backend::gpu::joint_tables::{JointParameters, RowParameters};
use jointsweep::internals::engine::backend::gpu::kernel_texts::{
    ANSWERING, ANSWERS, ASSEMBLE, Access, CONDENSE, DRAW, ELIMINATE, JOINTS, KERNEL_FILES, KernelFile,
    NARROW, PCG, REFINE, ROOFLINE, Sums, Variant, WORKS,
};
use jointsweep::internals::engine::backend::gpu::kernels::Precision;
use jointsweep::internals::engine::backend::gpu::layout::AssembleParameters;
use jointsweep::internals::engine::backend::gpu::system_layout::{
    SystemOutcome, SystemParameters, SystemState,
};
use jointsweep::internals::engine::backend::gpu::works::WorksParameters;
use jointsweep::internals::engine::backend::joints::{JointKind, MOST_NODES, TERMS};
use jointsweep::internals::engine::question::Question;
use jointsweep::internals::engine::question::drawn::{Shapes, functions};
use jointsweep::internals::engine::question::formula::Givens;
use jointsweep::internals::lab::gpu::speed::RooflineParameters;
use jointsweep::internals::mechanics::body::{Body, SHAPES, Side, annulus, cored_disc};
use jointsweep::internals::mechanics::compliance::arc::packed_count;
use jointsweep::internals::mechanics::compliance::ring_modes::{MOST_MODES, RingModes};
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::grading::{GradingClass, REFERENCE_LEVEL};
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::study::config::Study;
use wgpu::naga;
use wgpu::naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

const PRECISIONS: [Precision; 3] = [Precision::F32, Precision::F64, Precision::Mixed];

/// What a kernel of this precision may ask of a device.
fn capabilities(precision: Precision) -> Capabilities {
    match precision {
        Precision::F32 => Capabilities::empty(),
        Precision::F64 | Precision::Mixed => Capabilities::FLOAT64,
    }
}

fn needs(variant: &Variant) -> Capabilities {
    let subgroups = match variant.sums {
        Sums::Tree => Capabilities::empty(),
        Sums::Subgroups => Capabilities::SUBGROUP,
    };
    capabilities(variant.precision) | subgroups
}

fn check(source: &str, capabilities: Capabilities) -> Result<(naga::Module, ModuleInfo), String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|error| error.emit_to_string(source))?;
    Ok((module, info))
}

fn module(file: &KernelFile, precision: Precision) -> naga::Module {
    check(&file.source(precision, 64), capabilities(precision)).unwrap_or_else(|error| panic!("{error}")).0
}

#[test]
fn every_variant_is_valid() {
    for file in KERNEL_FILES.into_iter().chain([&JOINTS, &ROOFLINE]) {
        for precision in PRECISIONS {
            for (invocations, vectors, sums) in [
                (32, 0, Sums::Tree),
                (64, 1, Sums::Subgroups),
                (128, 4, Sums::Tree),
                (256, 4, Sums::Subgroups),
            ] {
                let on_chip = OnChip { vectors, capacity: 96 * vectors };
                let joints = if vectors == 1 {
                    JointKind { terms: 10, together: 1 }
                } else {
                    JointKind { terms: 6, together: 2 }
                };
                let variant = Variant { on_chip, joints, sums, ..Variant::plain(precision, invocations) };
                let (module, _) =
                    check(&file.variant(&variant), needs(&variant)).unwrap_or_else(|error| panic!("{error}"));
                let found: Vec<&str> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
                assert_eq!(found, file.entry_points, "{}", file.name);
                for entry in &module.entry_points {
                    assert_eq!(entry.workgroup_size, [invocations, 1, 1], "{}", entry.name);
                }
            }
        }
    }
}

const SHAPES_OF_JOINT: Shapes = [&cored_disc::SHAPE, &annulus::SHAPE];

/// Of the kernel that draws, with what is given of designs.
fn draw_text(functions: &str) -> String {
    DRAW.variant(&Variant::plain(Precision::F64, 64)) + functions
}

/// A kernel of answers with the functions of some questions: every operation, every column, constants and inputs.
#[test]
fn questions_are_valid() {
    let config = |select: &str, reduce: &str| {
        format!(
            "[joint]\nidealization = 'plane-stress'\nhole_radius = '10 mm'\nradial_clearance = '0.1 mm'\nthickness = ['5 mm', '6 mm']\n\
             [joint.pin]\nmodel = 'rigid-core'\ncore_radius_ratio = 0.2\nyoungs_modulus = '210 GPa'\npoissons_ratio = 0.3\n\
             [joint.plate]\nmodel = 'annulus'\nouter_radius_ratio = 3\nyoungs_modulus = '70 GPa'\npoissons_ratio = 0.3\n\
             [load]\nforce = ['1 kN', '2 kN']\n[output]\nlaws = false\n[select]\nkeep = \"{select}\"\n[reduce]\n{reduce}\n"
        )
    };
    let question = |select: &str, reduce: &str| {
        let study = Study::from_text(Path::new("asked.toml"), config(select, reduce)).unwrap();
        Question::of(&study)
    };
    let variant = Variant::plain(Precision::F32, ANSWERING);
    for (select, reduce, givens) in [
        ("force < 2 kN", "statistics = ['force']", [0, 2]),
        (
            "status == 'ok' and not (status == 'large displacement') or method != 'fe' and plate_model == 'annulus'",
            "statistics = ['indentation', 'tangent_stiffness', 'contact_half_angle', 'energy']\nquantiles = [0.5]",
            [1, 0],
        ),
        (
            "tangent_stiffness >= 1e5 N/mm and tangent_stiffness != 2e5 N/mm and step > 0 and peak_pressure == 3 MPa",
            "pareto = { largest = ['tangent_stiffness'], smallest = ['max(peak_pressure, 1 MPa)', 'energy / thickness^2'] }",
            [1, 1],
        ),
        (
            "force_error <= 0.01 and linearity_error < 1 and sqrt(abs(-thickness)) > 1 mm^0.5",
            "best = { by = 'log(peak_pressure / 1 MPa) + log10(force / 1 N) - exp(-indentation / 1 mm) * 2' }\n\
             histogram = [{ of = 'min(energy, 3 mJ)', from = '1 mJ', to = '2 mJ' }, { of = 'peak_pressure^0.5' }]",
            [1, 1],
        ),
    ] {
        let question = question(select, reduce).unwrap_or_else(|| panic!("{select}"));
        let found = [question.givens.of_design.len(), question.givens.of_row.len()];
        assert_eq!(found, givens, "{select}: {:?}", question.givens);
        let source = ANSWERS.variant(&variant) + &question.text;
        let (module, _) = check(&source, Capabilities::empty()).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(module.entry_points[0].name, ANSWERS.entry_points[0]);
        let bindings = module.global_variables.iter().filter(|(_, variable)| variable.binding.is_some());
        assert_eq!(bindings.count(), ANSWERS.bindings.len());
    }
    // What is given of designs that a device draws: all but functions, which it has in f32 alone.
    for (select, is_known) in [
        ("force / thickness > 100 N/mm and not (step == 1 or design < 3)", true),
        ("idealization != 'plane-strain' and max(thickness, 2 mm) * hole_radius^2 <= abs(-5 mm^3)", true),
        ("pin_model == 'rigid-core' and plate_youngs_modulus - pin_youngs_modulus != 3 GPa", true),
        ("core_radius_ratio < 0.3 and outer_radius_ratio >= 2 and min(pin_poissons_ratio, 0.3) > 0.2", true),
        ("sqrt(thickness / 1 mm) > 2", false),
    ] {
        let select = format!("{select} and peak_pressure < 100 MPa");
        let question = question(&select, "statistics = ['peak_pressure']").unwrap();
        let found = functions(&question.givens, SHAPES_OF_JOINT);
        assert_eq!(found.is_some(), is_known, "{select}");
        if let Some(found) = found {
            let (module, _) =
                check(&draw_text(&found), Capabilities::FLOAT64).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(module.entry_points[0].name, DRAW.entry_points[0]);
            let bindings = module.global_variables.iter().filter(|(_, variable)| variable.binding.is_some());
            assert_eq!(bindings.count(), DRAW.bindings.len());
        }
    }
    // What a device does not know.
    for (select, reduce) in [
        ("backend == 'gpu'", "statistics = ['force']"),
        ("force < 2 kN", "statistics = ['peak_pressure_angle']"),
    ] {
        assert!(question(select, reduce).is_none(), "{select} {reduce}");
    }
}

/// Negative control: what is wrong is found, by the parser, by the validator, and for want of f64.
#[test]
fn a_broken_kernel_is_refused() {
    let good = PCG.source(Precision::F32, 64);
    check(&good, Capabilities::empty()).unwrap();
    for (right, wrong) in [
        ("let beta = ", "let gamma = "),
        ("own += residual * (", "own += systems.outcome * ("),
        ("workgroupUniformLoad(&held)", "workgroupUniformLoad(&norms)"),
    ] {
        assert!(good.contains(right), "{right}");
        assert!(check(&good.replace(right, wrong), Capabilities::empty()).is_err(), "{wrong}");
    }
    assert!(check(&PCG.source(Precision::F64, 64), Capabilities::empty()).is_err());
}

/// Name and offset of each member, and the size of the whole.
type Layout = (Vec<(String, u32)>, u32);

fn layout_in(module: &naga::Module, name: &str) -> Option<Layout> {
    let (_, found) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name))?;
    let naga::TypeInner::Struct { members, span } = &found.inner else { return None };
    let member = |member: &naga::StructMember| (member.name.clone().unwrap_or_default(), member.offset);
    Some((members.iter().map(member).collect(), *span))
}

macro_rules! layout_here {
    ($name:ty, $($member:ident),+) => {
        (
            vec![$((stringify!($member).to_string(), offset_of!($name, $member) as u32)),+],
            size_of::<$name>() as u32,
        )
    };
}

#[test]
fn shared_structs_have_the_same_members_at_the_same_places() {
    let assemble: Layout = layout_here!(
        AssembleParameters,
        first_body,
        column_count,
        row_count,
        element_count,
        value_count,
        pair_count,
        system_count,
        side_count,
        is_plane_strain,
        shrinking_layers,
        bodies_at,
        shared_numbers_at,
        element_grid_at,
        pair_starts_at,
        sources_at,
        value_places_at,
        geometry_at,
        values_at,
        states_at
    );
    let systems: Layout = layout_here!(
        SystemParameters,
        unknown_count,
        value_count,
        block_count,
        ring_start,
        ring_count,
        step_count,
        iteration_limit,
        tolerance,
        goal
    );
    let state: Layout = layout_here!(SystemState, outcome, iterations);
    let works: Layout = layout_here!(WorksParameters, ring_count, block_count, mode_count, body_size);
    let eliminate: Layout = layout_here!(
        EliminateParameters,
        first_body,
        row_count,
        ring_row,
        border_count,
        mode_count,
        four_count,
        body_size,
        rows_at,
        places_at,
        loads_at,
        values_at,
        states_at,
        works_at
    );
    let roofline: Layout = layout_here!(RooflineParameters, trip_count, factor, term);
    assert_eq!(layout_in(&module(&ROOFLINE, Precision::F64), "RooflineParameters"), Some(roofline));
    let rows: Layout = layout_here!(
        RowParameters,
        product_count,
        degree_count,
        member_count,
        coefficient_stride,
        row_stride,
        order_count,
        products_at,
        coefficients_at,
        sizes_at,
        rows_at,
        before_ring,
        padding
    );
    assert_eq!(layout_in(&module(&JOINTS, Precision::F32), "Rows"), Some(rows));
    let places: Layout = layout_here!(
        Placed,
        parameters,
        numbers_at,
        found_at,
        load_count,
        works_at,
        terms,
        padding,
        near_fields_at
    );
    assert_eq!(layout_in(&module(&JOINTS, Precision::F32), "Place").as_ref(), Some(&places));
    let settings: Layout = layout_here!(
        DrawSettings,
        first,
        design_count,
        count,
        load_count,
        seed,
        stride,
        found_stride,
        given_of_design,
        given_of_row,
        behind_row,
        plate_fit_count,
        sides_at,
        loads_at,
        pairs_at,
        padding,
        more_padding
    );
    let drawing = draw_text(&functions(&Givens::default(), SHAPES_OF_JOINT).unwrap());
    let (drawing, _) = check(&drawing, Capabilities::FLOAT64).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(layout_in(&drawing, "Settings"), Some(settings));
    assert_eq!(layout_in(&drawing, "Place"), Some(places));
    let joints: Layout = layout_here!(
        JointParameters,
        bodies,
        node_count,
        space_at,
        turns_at,
        cosines_at,
        widest,
        negligible,
        together,
        padding
    );
    assert_eq!(layout_in(&module(&JOINTS, Precision::F32), "JointParameters"), Some(joints));
    for precision in PRECISIONS {
        assert_eq!(layout_in(&module(&ASSEMBLE, precision), "AssembleParameters").as_ref(), Some(&assemble));
        assert_eq!(layout_in(&module(&ASSEMBLE, precision), "SystemState").as_ref(), Some(&state));
        for file in [&NARROW, &PCG, &REFINE, &CONDENSE] {
            assert_eq!(layout_in(&module(file, precision), "SystemParameters").as_ref(), Some(&systems));
        }
        assert_eq!(layout_in(&module(&WORKS, precision), "WorksParameters").as_ref(), Some(&works));
        let in_text = layout_in(&module(&ELIMINATE, precision), "EliminateParameters");
        assert_eq!(in_text.as_ref(), Some(&eliminate));
        for file in [&PCG, &REFINE, &WORKS, &ELIMINATE] {
            assert_eq!(layout_in(&module(file, precision), "SystemState").as_ref(), Some(&state));
        }
    }
    // Negative control: two members exchanged.
    let source = PCG.source(Precision::F32, 64);
    let moved = source
        .replace("    outcome: u32,\n", "")
        .replace("    iterations: u32,\n}", "    iterations: u32,\n    outcome: u32,\n}");
    let exchanged = naga::front::wgsl::parse_str(
        &moved
            .replace("SystemState(stored.outcome[system], stored.iterations[system])", "SystemState(0u, 0u)"),
    )
    .unwrap();
    assert_ne!(layout_in(&exchanged, "SystemState"), Some(state));
}

/// Group 0, binding by binding: named, read or written as the host binds it.
#[test]
fn bindings_are_as_the_host_makes_them() {
    for file in KERNEL_FILES.into_iter().chain([&JOINTS, &ROOFLINE]) {
        let module = module(file, Precision::F32);
        let mut bindings: Vec<(u32, &str, Access)> = module
            .global_variables
            .iter()
            .filter_map(|(_, variable)| Some((variable.binding.as_ref()?, variable)))
            .map(|(binding, variable)| {
                assert_eq!(binding.group, 0);
                let access = match variable.space {
                    naga::AddressSpace::Uniform => Access::Uniform,
                    naga::AddressSpace::Storage { access } if access == naga::StorageAccess::LOAD => {
                        Access::Read
                    }
                    naga::AddressSpace::Storage { .. } => Access::Written,
                    space => panic!("{space:?} is bound"),
                };
                (binding.binding, variable.name.as_deref().unwrap_or_default(), access)
            })
            .collect();
        bindings.sort_by_key(|(binding, ..)| *binding);
        let expected: Vec<_> =
            (0..).zip(file.bindings).map(|(binding, (name, access))| (binding, *name, *access)).collect();
        assert_eq!(bindings, expected, "{}", file.name);
        // The least that every device of WebGPU has.
        assert!(file.storage_buffers() <= 8);
    }
}

/// wgpu does not check the memory of a workgroup, so the planner must know it.
#[test]
fn the_planner_knows_the_memory_of_a_workgroup() {
    for precision in PRECISIONS {
        for invocations in [2, 32, 128] {
            let facts = KernelFacts {
                bytes_per_real: precision.real_bytes(),
                bytes_per_wide: precision.wide_bytes(),
                invocations: u64::from(invocations),
                seconds_per_iteration: 1.0,
            };
            let filled = |vectors| OnChip { vectors, capacity: 96 };
            for on_chip in [OnChip::NOTHING, filled(1), filled(4)] {
                for sums in [Sums::Tree, Sums::Subgroups] {
                    let variant = Variant { on_chip, sums, ..Variant::plain(precision, invocations) };
                    // What elimination takes has a count of its own.
                    let others = KERNEL_FILES.into_iter().filter(|file| file.name != ELIMINATE.name);
                    let most = others.map(|file| workgroup_bytes(file, &variant)).max();
                    assert_eq!(most, Some(facts.workgroup_bytes(on_chip)), "{precision:?} {on_chip:?}");
                }
            }
        }
    }
}

#[test]
fn the_memory_of_a_front_is_known() {
    for precision in PRECISIONS {
        for front in [4, 16, 28]
            .into_iter()
            .flat_map(|rows| [true, false].map(|is_on_chip| Front { rows, is_on_chip }))
        {
            let variant = Variant { front, ..Variant::plain(precision, 64) };
            let found = workgroup_bytes(&ELIMINATE, &variant);
            assert_eq!(found, front.workgroup_bytes(precision.wide_bytes()), "{precision:?} {front:?}");
        }
    }
}

/// The least that a device of WebGPU has is enough for joints.
#[test]
fn joints_need_no_more_memory_than_any_device_has() {
    for (terms, together) in TERMS.into_iter().flat_map(|terms| [(terms, 1), (terms, 2)]) {
        let joints = JointKind { terms, together };
        let variant = Variant { joints, ..Variant::plain(Precision::F32, MOST_NODES as u32) };
        let bytes = workgroup_bytes(&JOINTS, &variant);
        println!("{bytes} bytes of a workgroup");
        assert!((8 * 1024..=16 * 1024).contains(&bytes), "{bytes}");
    }
}

fn workgroup_bytes(file: &KernelFile, variant: &Variant) -> u64 {
    let (module, _) = check(&file.variant(variant), needs(variant)).unwrap();
    let mut layouter = naga::proc::Layouter::default();
    layouter.update(module.to_ctx()).unwrap();
    let shared = module.global_variables.iter().filter(|(_, v)| v.space == naga::AddressSpace::WorkGroup);
    shared.map(|(_, variable)| u64::from(layouter[variable.ty].size)).sum()
}

/// A kernel is told the number of each outcome.
#[test]
fn outcomes_have_names_in_kernels() {
    let source = PCG.source(Precision::F32, 64);
    assert_eq!(SystemOutcome::ALL.len(), 7);
    for (number, (name, outcome)) in (0..).zip(SystemOutcome::ALL) {
        assert!(source.contains(&format!("const {name} = {number}u;")), "{name}");
        assert_eq!(SystemState { outcome: number, iterations: 0 }.outcome(), Some(outcome));
    }
    assert_eq!(SystemState { outcome: 7, iterations: 0 }.outcome(), None);
}

/// An invocation has room for its entries of as many modes as any mesh has.
#[test]
fn no_mesh_has_more_modes_than_the_kernel() {
    let module = module(&WORKS, Precision::F32);
    let (_, own) =
        module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some("OWN")).unwrap();
    let naga::Expression::Literal(naga::Literal::U32(own)) = module.global_expressions[own.init] else {
        panic!("{own:?}")
    };
    assert_eq!(own as usize, packed_count(MOST_MODES).div_ceil(64));
    let mut most = 0;
    for shape in SHAPES {
        for level in 0..=REFERENCE_LEVEL {
            for ratio in [1.001, 1.2, 3.0, 50.0, 1e4] {
                let parameters = if shape.side == Side::Pin { [1.0 / ratio; 3] } else { [ratio; 3] };
                let body = Body {
                    shape,
                    parameters,
                    support: 0,
                    poissons_ratio: 0.3,
                    idealization: Idealization::PlaneStrain,
                    lining: Default::default(),
                    all_around: false,
                };
                let class = GradingClass::of(&body, ElementKind::Quad8, level);
                most = most.max(RingModes::of(&class).count);
            }
        }
    }
    assert_eq!(most, MOST_MODES);
}
