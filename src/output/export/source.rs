//! Which designs of a result become a table, over which range, and whether their rows allow it.

use crate::engine::body_request::concentric;
use crate::error::Error;
use crate::output::export::numbers::rounded;
use crate::output::results::{Results, TableRow};
use crate::output::travel::Travel;
use crate::study::columns::{Cell, Column, Quantity, joint_columns};
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::JointDesign;

/// Which designs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selection {
    /// The only one there is.
    Only,
    /// By its number in the table.
    Design(u64),
    /// All of them: they differ in their radial clearance only.
    OverRadialClearance,
}

/// What the indentation is measured from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// As in the result: the pin's rigid part against the plate's support.
    Support,
    /// The mean motion of the pin's ring against that of the hole: only the local compliance is left.
    RingMean,
}

impl Reference {
    pub const ALL: [Reference; 2] = [Reference::Support, Reference::RingMean];

    pub fn name(self) -> &'static str {
        match self {
            Reference::Support => "support",
            Reference::RingMean => "ring-mean",
        }
    }
}

/// A joint of the result with what its rows tell.
pub struct Member {
    /// Of the first design that is this joint.
    pub design: u64,
    pub joint: JointDesign,
    pub rows: Vec<TableRow>,
}

/// The designs that become a table, by ascending clearance.
pub struct Source {
    pub members: Vec<Member>,
    pub solve: SolveOptions,
    /// The table ends so far from where the force begins, mm against the support.
    pub end: f64,
    pub reference: Reference,
    /// What the mean motion of both rings adds to the indentation, mm/N; zero where the support is the reference.
    pub ring_compliance: f64,
}

/// What its designs are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fits {
    /// One or more with clearance, or neat fits.
    Clearance,
    /// One press fit, whose table is that of a law without clearance.
    Press,
    /// Several of which some are press fits, with clearances below zero.
    Both,
}

/// Rows named in a complaint.
const NAMED_ROWS: usize = 5;

pub fn refuse<T>(what: impl Into<String>, problem: impl Into<String>) -> Result<T, Error> {
    Err(Error::Export { what: what.into(), problem: problem.into() })
}

impl Source {
    /// `up_to` in mm against the support; without it the range ends with the largest indentation of the rows. Rows
    /// with a remark are refused unless `allow_warned`, failed ones always.
    pub fn read(
        results: &Results,
        selection: Selection,
        reference: Reference,
        up_to: Option<f64>,
        allow_warned: bool,
    ) -> Result<Source, Error> {
        let solve = results.asked()?.solve;
        if solve.method == MethodChoice::ClosedForm {
            let problem = "it holds closed forms, which know nothing of the plate; export wants `auto`, `series` or `fe`";
            return refuse(results.dir().display().to_string(), problem);
        }
        let mut members = match selection {
            Selection::Design(number) => vec![member(number, results.design(number, &NEEDED)?)],
            Selection::Only => vec![only(results)?],
            Selection::OverRadialClearance => family(results)?,
        };
        members.iter_mut().for_each(Member::go_over_to_travel);
        let rows = || members.iter().flat_map(|member| &member.rows);
        let reached = rows().filter_map(|row| row.force.and(row.indentation));
        let largest = reached.fold(0.0, f64::max);
        let end = up_to.unwrap_or(largest);
        if end.is_nan() || end <= 0.0 {
            let way = members[members.len() - 1].travel().name();
            let problem = format!("no row has an answer at an {way} above 0: there is nothing to export");
            return refuse(designs_in_words(&members), problem);
        }
        for member in &members {
            member.check(end, up_to.is_some(), allow_warned)?;
        }
        let ring_compliance = match reference {
            Reference::Support => 0.0,
            Reference::RingMean => ring_compliance(&members[0].joint)?,
        };
        Ok(Source { members, solve, end, reference, ring_compliance })
    }

    pub fn fits(&self) -> Fits {
        match self.members.iter().any(|member| member.joint.is_press_fit()) {
            false => Fits::Clearance,
            true if self.is_family() => Fits::Both,
            true => Fits::Press,
        }
    }

    pub fn is_family(&self) -> bool {
        self.members.len() > 1
    }
}

/// What an export takes from a table besides the joints.
pub const NEEDED: [Quantity; 3] = [Quantity::Indentation, Quantity::Force, Quantity::Status];

fn member(design: u64, rows: Vec<TableRow>) -> Member {
    Member { design, joint: rows[0].joint.clone(), rows }
}

fn only(results: &Results) -> Result<Member, Error> {
    let rows = results.design(0, &NEEDED)?;
    let mut all = results.rows(&NEEDED)?;
    let mut last = 0;
    while let Some(design) = all.advance()? {
        last = last.max(design);
    }
    if last > 0 {
        let problem = format!(
            "the result has {} designs: name one (`design`), or ask for a table of all (`over` radial_clearance)",
            last + 1
        );
        return refuse("design", problem);
    }
    Ok(member(0, rows))
}

/// All designs of a result that differ in their radial clearance only; rows of the same joint become one member.
fn family(results: &Results) -> Result<Vec<Member>, Error> {
    let (mut members, mut differing): (Vec<Member>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut rows = results.rows(&NEEDED)?;
    let all = joint_columns(rows.layer_counts());
    let others: Vec<Column> = all.into_iter().filter(|column| *column != Column::RadialClearance).collect();
    let cells =
        |joint: &JointDesign| -> Vec<Cell> { others.iter().map(|column| column.cell(joint)).collect() };
    while let Some(design) = rows.advance()? {
        let row = rows.row()?;
        if let Some(first) = members.first() {
            let (first, own) = (cells(&first.joint), cells(&row.joint));
            for i in (0..others.len()).filter(|i| first[*i] != own[*i]) {
                if !differing.contains(&i) {
                    differing.push(i);
                }
            }
        }
        if !differing.is_empty() {
            continue;
        }
        let clearance = row.joint.radial_clearance;
        match members.iter_mut().rev().find(|member| member.joint.radial_clearance == clearance) {
            Some(member) => member.rows.push(row),
            None => members.push(Member { design, joint: row.joint.clone(), rows: vec![row] }),
        }
    }
    if !differing.is_empty() {
        differing.sort_unstable();
        let names: Vec<String> = differing.iter().map(|i| format!("`{}`", others[*i].name())).collect();
        let problem = format!(
            "the designs differ in {} too: a table over the clearance wants a result whose designs differ in nothing else",
            names.join(", ")
        );
        return refuse("over radial_clearance", problem);
    }
    if members.len() < 2 {
        let problem =
            "the result has one clearance only: leave `over` out, or run a sweep over `radial_clearance`";
        return refuse("over radial_clearance", problem);
    }
    members.sort_by(|a, b| a.joint.radial_clearance.total_cmp(&b.joint.radial_clearance));
    Ok(members)
}

fn designs_in_words(members: &[Member]) -> String {
    match members {
        [one] => format!("design {}", one.design),
        _ => format!("{} designs", members.len()),
    }
}

/// An offset below this share of the overlap is what an indentation of nine digits leaves of none.
const AT_REST: f64 = 1e-8;

impl Member {
    /// What its part of the table is over: of a press fit the offset.
    pub fn travel(&self) -> Travel {
        Travel::of_force(&self.joint)
    }

    /// From the indentations that tables have, and their offsets, which are exact where they were asked.
    fn go_over_to_travel(&mut self) {
        let travel = self.travel();
        if travel == Travel::Indentation {
            return;
        }
        let least = AT_REST * self.joint.radial_clearance.abs();
        for row in &mut self.rows {
            let of_indentation = |indentation| travel.of_indentation(indentation, &self.joint);
            let way = row.offset.or_else(|| row.indentation.map(of_indentation));
            row.indentation = way.map(|way| if way < least { 0.0 } else { rounded(way, 12) });
        }
    }

    /// Refuses a range with rows that are not to be relied on.
    fn check(&self, end: f64, is_chosen: bool, allow_warned: bool) -> Result<(), Error> {
        // A range that nobody chose holds all rows, also those without an answer.
        let inside = |row: &&TableRow| match (row.indentation, row.force) {
            _ if !is_chosen => true,
            (Some(indentation), _) => indentation <= end * (1.0 + 1e-12),
            (None, Some(force)) => force <= self.greatest_force(end),
            (None, None) => true,
        };
        let rows: Vec<&TableRow> = self.rows.iter().filter(inside).collect();
        let failed: Vec<&TableRow> =
            rows.iter().copied().filter(|row| row.force.is_none() || row.indentation.is_none()).collect();
        if !failed.is_empty() {
            let problem = format!(
                "{} of its rows failed ({}): end the range before them (`--up-to`)",
                failed.len(),
                named(&failed)
            );
            return refuse(format!("design {}", self.design), problem);
        }
        let warned: Vec<&TableRow> = rows.into_iter().filter(|row| !row.is_ok()).collect();
        if !warned.is_empty() && !allow_warned {
            let problem = format!(
                "{} of its rows are not ok ({}): end the range before them (`--up-to`), or take them all the same (`--allow-warned`)",
                warned.len(),
                named(&warned)
            );
            return refuse(format!("design {}", self.design), problem);
        }
        Ok(())
    }

    fn greatest_force(&self, end: f64) -> f64 {
        let inside = |row: &&TableRow| row.indentation.is_some_and(|indentation| indentation <= end);
        self.rows.iter().filter(inside).filter_map(|row| row.force).fold(0.0, f64::max)
    }
}

/// "at 0.1 mm: large displacement; at 2000 N: failed: ...; and 3 more".
fn named(rows: &[&TableRow]) -> String {
    let one = |row: &&TableRow| match (row.indentation, row.force) {
        (Some(indentation), _) => format!("at {indentation} mm: {}", row.status),
        (None, Some(force)) => format!("at {force} N: {}", row.status),
        (None, None) => row.status.clone(),
    };
    let mut told: Vec<String> = rows.iter().take(NAMED_ROWS).map(one).collect();
    if rows.len() > NAMED_ROWS {
        told.push(format!("and {} more", rows.len() - NAMED_ROWS));
    }
    told.join("; ")
}

/// Mean motion of the hole's ring along the load and of the pin's against it, mm/N. A pressure p cos(phi) carries
/// F = pi R t p.
fn ring_compliance(joint: &JointDesign) -> Result<f64, Error> {
    let mut sum = 0.0;
    for part in [&joint.pin, &joint.plate] {
        if !part.shape.concentric {
            let problem = format!(
                "the mean motion of the ring is known of concentric bodies only (`rigid-core`, `annulus`), not of `{}`; \
                 `reference support` is there for every body",
                part.shape.name
            );
            return refuse("reference ring-mean", problem);
        }
        let body = concentric(&joint.body(part));
        sum += body.mean_ring_motion()
            / (std::f64::consts::PI * joint.thickness * part.contact_material().youngs_modulus);
    }
    Ok(sum)
}
