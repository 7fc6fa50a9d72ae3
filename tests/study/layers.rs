//! Layers of parts: how they are read, swept, listed and refused.

use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::setting::Setting;

use crate::{BASE, Folder, RADIUS, all, row, with, written};

/// A bush of two thicknesses over another layer.
const LAYERS: &str = r#"
[[joint.plate.layers]]
thickness      = ["1 mm", "2 mm"]
youngs_modulus = "3 GPa"
poissons_ratio = 0.4
[[joint.plate.layers]]
thickness_ratio = 0.05
youngs_modulus  = { from = "50 GPa", to = "70 GPa", count = 3 }
poissons_ratio  = 0.33
[load]
"#;

fn lined(layers: &str) -> String {
    with("[load]\n", layers)
}

#[test]
fn layers_sweep_like_everything_else() {
    let folder = Folder::new("layers");
    let radii = r#"hole_radius      = ["100 mm", "200 mm"]"#;
    let study = folder.study(&lined(LAYERS).replace(RADIUS, radii));
    let designs = all(&study);
    assert_eq!(designs.len(), 12);
    let last = &designs[11].joint;
    assert!(last.pin.layers.is_empty());
    let layers = last.plate.layers.list();
    assert_eq!((layers.len(), layers[0].thickness, layers[1].thickness), (2, 2.0, 10.0));
    assert_eq!((layers[0].material.youngs_modulus, layers[1].material.youngs_modulus), (3000.0, 70e3));
    assert_eq!(last.plate.contact_material().poissons_ratio, 0.4);
    assert_eq!(study.factors(), ["hole_radius", "plate.layers.1.thickness", "plate.layers.2.youngs_modulus"]);
    // A body has no size: that of the same ratios in a hole twice as large is the same.
    let [small, large] = [&designs[0].joint, &designs[9].joint].map(|joint| joint.body(&joint.plate));
    assert_eq!(large.lining.list().len(), 2);
    assert_eq!(small, large);
    let constants: Vec<String> = study.constants().iter().map(|(column, _)| column.name()).collect();
    let is_constant = |name: &str| constants.iter().any(|own| own == name);
    // A ratio is another thickness in another hole.
    assert!(!is_constant("plate_layer2_thickness_mm") && !is_constant("plate_layer1_thickness_mm"));
    assert!(is_constant("plate_layer2_poissons_ratio") && is_constant("plate_layer1_youngs_modulus_mpa"));

    let config = folder.write("config.toml", lined(LAYERS));
    let setting = Setting::parse("joint.plate.layers.1.thickness=4 mm", "--set").unwrap();
    let study = Study::load_with(&config, &[setting]).unwrap();
    assert_eq!(all(&study).len(), 3);
}

#[test]
fn a_list_of_lined_designs_reads_back_what_was_written() {
    let folder = Folder::new("layers-list");
    let original = all(&folder.study(&lined(LAYERS)));
    let text = written(&original, ",", "100");
    folder.write("designs.csv", &text);
    let study = folder.study("[designs]\nfile = \"designs.csv\"\n");
    let read = all(&study);
    assert_eq!(read.len(), 6);
    assert_eq!((study.extras().layers.pin, study.extras().layers.plate), (0, 2));
    for (read, original) in read.iter().zip(&original) {
        assert_eq!(row(read), row(original));
    }
    // A row with the first layer alone, and one with none.
    let second = "1,3000,0.4,5,50000,0.33";
    assert!(text.contains(second));
    folder.write("designs.csv", text.replacen(second, "1,3000,0.4,,,", 1).replacen(second, ",,,,,", 1));
    let counts: Vec<usize> = all(&folder.study("[designs]\nfile = \"designs.csv\"\n"))
        .iter()
        .map(|case| case.joint.plate.layers.list().len())
        .collect();
    assert_eq!(counts[0], 1);
    for (broken, problem) in [
        (
            text.replacen(second, ",,,5,50000,0.33", 1),
            "plate_layer2_thickness_mm: `plate_layer1_thickness_mm` is empty",
        ),
        (
            text.replacen(second, "1,,0.4,5,50000,0.33", 1),
            "plate_layer1_youngs_modulus_mpa: the cell is empty",
        ),
        (
            text.replacen(second, "1,3000,0.5,5,50000,0.33", 1),
            "plate_layer1_poissons_ratio: `0.5`: must be above -1",
        ),
        (
            text.replacen("plate_layer1_thickness_mm", "plate_layer9_thickness_mm", 1),
            "unknown column; did you mean",
        ),
    ] {
        folder.write("designs.csv", broken);
        let said = folder.refusal("[designs]\nfile = \"designs.csv\"\n");
        assert!(said.contains(problem), "{said}");
    }
}

#[test]
fn bad_layers_are_refused_by_line_and_key() {
    let folder = Folder::new("layers-bad");
    #[rustfmt::skip]
    let edits = [
        ("thickness_ratio = 0.05", "thicknes_ratio = 0.05", ":22: joint.plate.layers.2.thicknes_ratio: unknown key; did you mean `thickness_ratio`?"),
        ("thickness_ratio = 0.05", "# none", ":21: joint.plate.layers.2: the key `thickness` (or `thickness_ratio`) is missing"),
        ("thickness_ratio = 0.05", "thickness = '1 mm'\nthickness_ratio = 0.05", ":23: joint.plate.layers.2.thickness_ratio: `thickness` is given, too"),
        ("thickness_ratio = 0.05", "thickness_ratio = 0", ":22: joint.plate.layers.2.thickness_ratio: `0`: must be above 0"),
        ("[\"1 mm\"", "[\"1 N\"", "joint.plate.layers.1.thickness: `\"1 N\"`"),
        ("poissons_ratio  = 0.33", "", "joint.plate.layers.2: the key `poissons_ratio` is missing"),
    ];
    for (old, new, problem) in edits {
        let config = lined(LAYERS);
        assert_eq!(config.matches(old).count(), 1, "{old}");
        let said = folder.refusal(config.replace(old, new));
        assert!(said.contains(problem), "{new}: {said}");
    }
    let one =
        "\n[[joint.plate.layers]]\nthickness = \"1 mm\"\nyoungs_modulus = \"3 GPa\"\npoissons_ratio = 0.4\n";
    let said = folder.refusal(lined(&format!("{}[load]\n", one.repeat(9))));
    assert!(said.contains("joint.plate.layers: 9 layers; at most 8 are allowed"), "{said}");
    assert_eq!(all(&folder.study(&lined(&format!("{}[load]\n", one.repeat(8))))).len(), 1);
    let block = "model = \"block\"\nhalf_width_ratio = 2\ndepth_ratio = 2\nheight_ratio = 2\n";
    let annulus = "model              = \"annulus\"\nouter_radius_ratio = 2.0\n";
    // Every model can have layers.
    assert!(lined(LAYERS).contains(annulus));
    let of_block = all(&folder.study(&lined(LAYERS).replace(annulus, block)));
    assert!(!of_block.is_empty() && of_block.iter().all(|case| case.joint.plate.layers.list().len() == 2));
    let said = folder.refusal(BASE.replace("[joint.plate]", "[joint.plate]\nlayers = \"1 mm\""));
    assert!(
        said.contains(
            "joint.plate.layers: `\"1 mm\"`: a list of tables, [[joint.plate.layers]], is needed here"
        ),
        "{said}"
    );
    let columns = "[output]\ncolumns = [\"design\", \"plate_layer3_thickness_mm\"]\n[load]\n";
    let said = folder.refusal(lined(LAYERS).replace("[load]\n", columns));
    assert!(
        said.contains(
            "output.columns: `plate_layer3_thickness_mm`: no design of this config has such a layer"
        ),
        "{said}"
    );
}

const RIGID_CORE: &str = "model          = \"rigid-core\"\n";

/// Held at its bore a tube is a disc around a rigid core; moved by an inner part it is a layer of that, behind its own.
#[test]
fn a_tube_is_a_rigid_core_or_a_layer_around_one() {
    let folder = Folder::new("tubes");
    assert!(BASE.contains(RIGID_CORE), "{BASE}");
    let pin = |model: &str| all(&folder.study(&BASE.replace(RIGID_CORE, model)));
    let held = pin("model = \"tube\"\nbore_radius_ratio = [0.4, 0.6]\n");
    let cores = pin("model = \"rigid-core\"\ncore_radius_ratio = [0.4, 0.6]\n");
    assert!(held.len() == cores.len() && held.len() >= 2);
    for (tube, core) in held.iter().zip(&cores) {
        assert_eq!(row(tube), row(core));
    }

    let own =
        "[[joint.pin.layers]]\nthickness_ratio = 0.05\nyoungs_modulus = \"4 GPa\"\npoissons_ratio = 0.4\n";
    let inner = "[joint.pin.inner]\ncore_radius_ratio = 0.2\nyoungs_modulus = \"3 GPa\"\npoissons_ratio = 0.35\nyield_stress = \"60 MPa\"\n\
                 [[joint.pin.inner.layers]]\nthickness = \"2 mm\"\nyoungs_modulus = \"1 GPa\"\npoissons_ratio = 0.45\n";
    let config = BASE
        .replace(RIGID_CORE, "model = \"tube\"\nbore_radius_ratio = [0.5, 0.6]\n")
        .replace("[joint.plate]", &format!("{own}{inner}[joint.plate]"));
    let study = folder.study(&config);
    let designs = all(&study);
    assert_eq!(designs.len(), held.len());
    let pin = &designs[0].joint.pin;
    let radius = designs[0].joint.hole_radius - designs[0].joint.radial_clearance;
    let layers = pin.layers.list();
    let thickness = [0.05, 0.45, 2.0 / radius].map(|ratio| ratio * radius);
    for (layer, expected) in layers.iter().zip(thickness) {
        assert!((layer.thickness - expected).abs() < 1e-12 * radius, "{} {expected}", layer.thickness);
    }
    let moduli: Vec<f64> = layers.iter().map(|layer| layer.material.youngs_modulus).collect();
    assert_eq!(moduli, [4e3, held[0].joint.pin.material.youngs_modulus, 1e3]);
    assert_eq!((pin.shape.name, pin.parameters[0], pin.yield_stress), ("rigid-core", 0.2, Some(60.0)));
    assert_eq!((pin.material.youngs_modulus, pin.material.poissons_ratio), (3e3, 0.35));
    assert_eq!(study.extras().layers.pin, 3);
    // The tube becomes thinner with its bore, the layers stay.
    let constants: Vec<String> = study.constants().iter().map(|(column, _)| column.name()).collect();
    let is_constant = |layer: usize| constants.contains(&format!("pin_layer{layer}_thickness_mm"));
    assert_eq!([1, 2, 3].map(is_constant), [true, false, true]);

    // Layers as thick as the tube, a core as wide as the bore, and layers as thick as the inner part: in words of the config.
    for (old, new, problem) in [
        (
            "thickness_ratio = 0.05",
            "thickness_ratio = 0.5",
            "the layers of the tube are 50 mm thick; they must be thinner than its wall, 50 mm",
        ),
        (
            "core_radius_ratio = 0.2",
            "core_radius_ratio = 0.6",
            "core_radius_ratio of the tube's inner part is 0.6; it must be below bore_radius_ratio, 0.5",
        ),
        (
            "core_radius_ratio = 0.2",
            "core_radius_ratio = 0.49",
            "the layers of the tube's inner part are 2 mm thick; they must be thinner than its wall, 0.999 mm",
        ),
    ] {
        assert!(config.contains(old));
        let design = all(&folder.study(&config.replace(old, new))).remove(0);
        assert_eq!(design.joint.no_room(&design.joint.pin).unwrap().to_string(), problem);
    }
    assert_eq!(designs[0].joint.no_room(pin), None);
}

/// A number that no layer has.
#[test]
fn a_missing_layer_is_said_with_how_many_there_are() {
    let folder = Folder::new("layers-number");
    let one =
        LAYERS.split("[[joint.plate.layers]]").take(2).collect::<Vec<_>>().join("[[joint.plate.layers]]");
    for (layers, problem) in [
        (format!("{one}[load]\n"), "`joint.plate.layers` has only 1 table; there is no number 3"),
        (LAYERS.to_string(), "`joint.plate.layers` has only 2 tables; there is no number 3"),
    ] {
        let config = folder.write("config.toml", lined(&layers));
        let setting = Setting::parse("joint.plate.layers.3.thickness=4 mm", "--set").unwrap();
        let said = Study::load_with(&config, &[setting]).unwrap_err().to_string();
        assert_eq!(said, format!("--set: joint.plate.layers.3.thickness: {problem}"));
    }
}

#[test]
fn what_is_wrong_with_a_tube_is_said_by_key() {
    let folder = Folder::new("tubes-bad");
    let tube = "model = \"tube\"\nbore_radius_ratio = 0.5\n";
    let part = "[joint.pin.inner]\nyoungs_modulus = \"3 GPa\"\npoissons_ratio = 0.35\n[joint.plate]";
    let layer =
        "[[joint.pin.layers]]\nthickness_ratio = 0.01\nyoungs_modulus = \"4 GPa\"\npoissons_ratio = 0.4\n";
    for (model, inner, problem) in [
        ("model = \"tube\"\n", "[joint.plate]", "joint.pin: the key `bore_radius_ratio` is missing"),
        ("model = \"tub\"\n", "[joint.plate]", "did you mean `tube`?"),
        (
            "model = \"tube\"\nbore_radius_ratio = 1\n",
            "[joint.plate]",
            "joint.pin.bore_radius_ratio: `1`: must be above 0 and below 1",
        ),
        (
            "model = \"rigid-core\"\nbore_radius_ratio = 0.5\n",
            "[joint.plate]",
            "joint.pin.bore_radius_ratio: model `rigid-core` does not have this key; model `tube` does",
        ),
        (tube, &part.replace("inner]", "inner]\nmodel = \"tube\""), "joint.pin.inner.model: unknown key"),
        (tube, &format!("{}{part}", layer.repeat(8)), "joint.pin.inner: with the tube 9 layers; at most 8"),
    ] {
        let said = folder.refusal(BASE.replace(RIGID_CORE, model).replace("[joint.plate]", inner));
        assert!(said.contains(problem), "{model}: {said}");
    }
}
