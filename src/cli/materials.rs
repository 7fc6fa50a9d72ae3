//! `jointsweep materials`: how much of the work and of the force each material of a joint decides, of chosen designs of a config.

use std::fmt::Write as _;

use clap::Args;
use jointsweep::internals::output::number::rounded_cell;
use jointsweep::internals::study::columns::side_name;
use jointsweep::{Error, Joint, MaterialShare, material_shares};

use super::chosen_designs::ChosenDesigns;
use super::{Ending, say};

#[derive(Args)]
pub struct MaterialsArgs {
    #[command(flatten)]
    chosen: ChosenDesigns,
}

/// Layers are counted from the contact; 0 is the part's own material.
const HEADER: &str = "design,step,part,layer,youngs_modulus_mpa,energy_share,force_share\n";

pub fn materials(args: &MaterialsArgs) -> Result<Ending, Error> {
    args.chosen.write(HEADER, "strain energy", |text, case, options| {
        let (design, mut all) = (case.index, true);
        let joint = Joint::try_from(case.joint)?;
        for (step, (load, shares)) in
            case.steps.iter().zip(material_shares(&joint, &case.steps, options)?).enumerate()
        {
            let Some(shares) = shares else {
                say(&format!("design {design}, step {step} ({load}): no answer"));
                all = false;
                continue;
            };
            for MaterialShare { side, layer, energy, force } in shares {
                let modulus = rounded_cell(joint.design().youngs_modulus(side, layer));
                let cell = |share: f64| if share.is_nan() { String::new() } else { rounded_cell(share) };
                let shares = [energy, force].map(cell).join(",");
                let _ = writeln!(text, "{design},{step},{},{layer},{modulus},{shares}", side_name(side));
            }
        }
        Ok(all)
    })
}
