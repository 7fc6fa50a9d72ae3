//! TOML -> validated study: the only place where a person's words become a sweep.

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::mechanics::compliance::near_field::InCommon;
use crate::study::cases::Cases;
use crate::study::columns::{Cell, Column, Extras};
use crate::study::design::{DesignCase, Limits, Load};
use crate::study::designs_file::DesignsFile;
use crate::study::draw_tables::DrawTables;
use crate::study::expression::Expression;
use crate::study::fingerprint::Fingerprint;
use crate::study::layers::LayerCounts;
use crate::study::output_options::OutputOptions;
use crate::study::recipe::Recipe;
use crate::study::reduce::{Reduce, read_select};
use crate::study::sampling::{MAX_DESIGNS, Scheme};
use crate::study::setting::Setting;
use crate::study::source::{Section, Source};
use crate::study::units::{self, Dimension};
use crate::study::values::{Counts, Pick, Values};

/// Which methods may be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodChoice {
    /// The cheapest whose estimated error meets the accuracy.
    Auto,
    ClosedForm,
    Series,
    Fe,
}

impl MethodChoice {
    pub const ALL: [MethodChoice; 4] =
        [MethodChoice::Auto, MethodChoice::ClosedForm, MethodChoice::Series, MethodChoice::Fe];

    /// The name in configs.
    pub fn name(self) -> &'static str {
        match self {
            MethodChoice::Auto => "auto",
            MethodChoice::ClosedForm => "closed-form",
            MethodChoice::Series => "series",
            MethodChoice::Fe => "fe",
        }
    }
}

/// How well and by which method each design is to be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveOptions {
    /// Relative error of the force, in (0, 1).
    pub accuracy: f64,
    pub method: MethodChoice,
}

impl Default for SolveOptions {
    fn default() -> SolveOptions {
        SolveOptions { accuracy: 0.01, method: MethodChoice::Auto }
    }
}

/// Designs up to which laws are fitted without being asked for: three megabytes of them, in a tenth of a second.
pub const LAWS_UP_TO: u64 = 1000;

/// The most steps that the table `load` may have.
pub const MAX_STEPS: u64 = 100_000;

/// What a config asks for. All that can be wrong with it has been found when there is one.
#[derive(Debug)]
pub struct Study {
    source: Source,
    title: String,
    pub solve: SolveOptions,
    /// Whether bodies may be interpolated where that is cheaper.
    pub interpolation: bool,
    /// The condition of the rows that are wanted; `None` for all rows.
    pub select: Option<Expression>,
    /// What is asked of all kept rows together.
    pub reduce: Option<Reduce>,
    pub output: OutputOptions,
    designs: Designs,
}

#[derive(Debug)]
enum Designs {
    Sampled { recipe: Box<Recipe>, steps: Vec<Load> },
    Listed(DesignsFile),
}

impl Designs {
    fn constants(&self) -> Vec<(Column, Cell)> {
        match self {
            Designs::Sampled { recipe, .. } => recipe.constants(),
            Designs::Listed(file) => file.constants().to_vec(),
        }
    }

    fn extras(&self) -> Extras {
        match self {
            Designs::Sampled { recipe, steps } => {
                let is_offset = steps.iter().any(|load| matches!(load, Load::Offset(_)));
                Extras {
                    layers: recipe.layer_counts(),
                    offset: is_offset || recipe.has_press_fits(),
                    peak_angle: recipe.layer_counts() != LayerCounts::NONE || recipe.has_lopsided_fits(),
                }
            }
            Designs::Listed(file) => file.extras(),
        }
    }
}

impl Study {
    /// Reads and checks a config, and the list of designs it may name.
    pub fn load(path: &Path) -> Result<Study, Error> {
        Study::load_with(path, &[])
    }

    /// The same with values set beside the file, as if the file had them: its text, too, is the one that has them.
    pub fn load_with(path: &Path, settings: &[Setting]) -> Result<Study, Error> {
        let mut source = Source::read(path.to_path_buf())?;
        source.set(settings)?;
        Study::read(source)
    }

    /// Checks a config whose text is at hand; `path` is what complaints and manifests call it.
    pub fn from_text(path: &Path, text: String) -> Result<Study, Error> {
        Study::from_text_with(path, text, &[])
    }

    /// The same with values set beside the text.
    pub fn from_text_with(path: &Path, text: String, settings: &[Setting]) -> Result<Study, Error> {
        let mut source = Source::new(path.to_path_buf(), text);
        source.set(settings)?;
        Study::read(source)
    }

    fn read(source: Source) -> Result<Study, Error> {
        let path = &source.path;
        let document = source.parse()?;
        let root = source.root(&document);
        root.allow(&[
            "title", "joint", "load", "designs", "sampling", "solve", "select", "reduce", "output",
        ])?;
        let title = match root.find("title") {
            Some(item) => item.string()?.to_string(),
            None => stem(path),
        };
        let default = Ok((SolveOptions::default(), true));
        let (solve, interpolation) = root.section("solve")?.map_or(default, |table| read_solve(&table))?;
        let select = root.section("select")?.map(|table| read_select(&table)).transpose()?;
        let reduce = root.section("reduce")?.map(|table| Reduce::read(&table)).transpose()?;
        let output_table = root.section("output")?;
        let output = output_table.as_ref().map_or(Ok(OutputOptions::default()), OutputOptions::read)?;
        let designs = match root.section("designs")? {
            Some(list) => {
                for key in ["joint", "load", "sampling"] {
                    if let Some(item) = root.find(key) {
                        return Err(item.error("has no place beside [designs], whose file says it all"));
                    }
                }
                Designs::Listed(read_list(&list, path)?)
            }
            None => {
                let table = |key: &str| match root.section(key)? {
                    Some(table) => Ok(table),
                    None => {
                        Err(root.error(format!("the table [{key}] is missing (or [designs] instead of it)")))
                    }
                };
                let recipe = Box::new(Recipe::read(&table("joint")?, read_sampling(&root)?)?);
                let steps = read_load(&table("load")?, &recipe)?;
                Designs::Sampled { recipe, steps }
            }
        };
        if let Some(table) = &output_table {
            output.check(table, &designs.constants(), designs.extras())?;
        }
        Ok(Study { title, solve, interpolation, select, reduce, output, designs, source })
    }

    /// The same joint in a design for sensitivity indices instead of what `[sampling]` says, under one load step (from 1; the
    /// last one where none is named) and without laws.
    pub fn for_sensitivity(mut self, samples: u64, seed: u64, step: Option<u64>) -> Result<Study, Error> {
        let refuse =
            |problem: String| Error::Asked { problem: format!("{}: {problem}", self.source.path.display()) };
        let Designs::Sampled { recipe, steps } = &self.designs else {
            return Err(refuse(
                "the designs of [designs] are a fixed list: a sensitivity needs factors that vary each by itself; give [joint] \
                 with ranges and lists in its place"
                    .into(),
            ));
        };
        let step = step.unwrap_or(steps.len() as u64);
        let place = usize::try_from(step).ok().and_then(|step| step.checked_sub(1));
        let Some(&load) = place.and_then(|place| steps.get(place)) else {
            return Err(refuse(format!("there is no load step {step}: the config has {}", steps.len())));
        };
        let recipe = Box::new(recipe.for_sensitivity(samples, seed).map_err(refuse)?);
        self.designs = Designs::Sampled { recipe, steps: vec![load] };
        self.output.laws = Some(false);
        Ok(self)
    }

    /// What sweeps, by its keys in `[joint]`, as listed; nothing for a list of designs.
    pub fn factors(&self) -> Vec<&str> {
        match &self.designs {
            Designs::Sampled { recipe, .. } => recipe.factors(),
            Designs::Listed(_) => Vec::new(),
        }
    }

    /// What is given and does nothing, in sentences that begin with its key.
    pub fn without_effect(&self) -> Vec<String> {
        match &self.designs {
            Designs::Sampled { recipe, .. } => recipe.unused_yield_stresses(),
            Designs::Listed(_) => Vec::new(),
        }
    }

    /// The load steps of each design; nothing for a list of designs, whose rows have their own.
    pub fn loads(&self) -> &[Load] {
        match &self.designs {
            Designs::Sampled { steps, .. } => steps,
            Designs::Listed(_) => &[],
        }
    }

    /// By which a device draws the designs; `None` where it cannot.
    pub fn draw_tables(&self) -> Option<DrawTables> {
        match &self.designs {
            Designs::Sampled { recipe, .. } => recipe.draw_tables(),
            Designs::Listed(_) => None,
        }
    }

    /// The title, or the file's name when there is none.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The config as it was read, to the last byte; with what was set beside its file, where something was.
    pub fn source_text(&self) -> &str {
        &self.source.text
    }

    pub fn path(&self) -> &Path {
        &self.source.path
    }

    /// The config's file name without its extension.
    pub fn name(&self) -> String {
        stem(&self.source.path)
    }

    /// The list of designs, when the config names one.
    pub fn designs_file(&self) -> Option<&Path> {
        match &self.designs {
            Designs::Sampled { .. } => None,
            Designs::Listed(file) => Some(file.path()),
        }
    }

    /// What tells the config and the list of designs that it names from others, with their paths.
    pub fn inputs(&self) -> Vec<(&Path, Fingerprint)> {
        let mut inputs = vec![(self.path(), Fingerprint::of(self.source_text().as_bytes()))];
        if let Designs::Listed(file) = &self.designs {
            inputs.push((file.path(), file.fingerprint()));
        }
        inputs
    }

    /// Whether laws are fitted: as asked, or for sweeps of up to `LAWS_UP_TO` designs. A closed form has no curve to fit.
    pub fn fits_laws(&self) -> bool {
        let is_small = self.design_count() <= LAWS_UP_TO;
        self.output.laws.unwrap_or(is_small) && self.solve.method != MethodChoice::ClosedForm
    }

    /// The inputs that are the same in all designs, in the order of the table's columns.
    pub fn constants(&self) -> Vec<(Column, Cell)> {
        self.designs.constants()
    }

    /// What its bodies have in common by the words of `[joint]`. Of a list of designs that is nothing, whatever it holds: a result must say it
    /// when the list is gone.
    pub fn in_common(&self) -> InCommon {
        match &self.designs {
            Designs::Sampled { recipe, .. } => recipe.in_common(),
            Designs::Listed(_) => InCommon::default(),
        }
    }

    /// Which columns its table has of those that only some have.
    pub fn extras(&self) -> Extras {
        self.designs.extras()
    }

    /// Whether the rows themselves are written: as asked, or where nothing is asked of all rows together.
    pub fn writes_table(&self) -> bool {
        self.output.table.unwrap_or(self.reduce.is_none())
    }

    pub fn design_count(&self) -> u64 {
        match &self.designs {
            Designs::Sampled { recipe, .. } => recipe.sampler().design_count(),
            Designs::Listed(file) => file.row_count(),
        }
    }

    /// Load steps of each design.
    pub fn steps_per_design(&self) -> u64 {
        match &self.designs {
            Designs::Sampled { steps, .. } => steps.len() as u64,
            Designs::Listed(_) => 1,
        }
    }

    /// Load steps of all designs together: the rows of the table.
    pub fn step_count(&self) -> u64 {
        self.design_count().saturating_mul(self.steps_per_design())
    }

    /// The designs in their order, each made when it is asked for. From the start at every call.
    pub fn cases(&self) -> Result<Cases<'_>, Error> {
        Ok(match &self.designs {
            Designs::Sampled { recipe, steps } => Cases::sampled(recipe, steps),
            Designs::Listed(file) => Cases::listed(file.rows()?),
        })
    }

    /// Those of these numbers, which ascend: what lies between them is skipped.
    pub fn cases_at<'a>(
        &'a self,
        numbers: impl IntoIterator<Item = u64> + 'a,
    ) -> Result<impl Iterator<Item = Result<DesignCase, Error>> + 'a, Error> {
        let (mut cases, mut next) = (self.cases()?, 0);
        Ok(numbers.into_iter().filter_map(move |number| {
            let skipped = number.checked_sub(next)?;
            next = number + 1;
            cases.nth(skipped as usize)
        }))
    }
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// What a config says of its whole sweep: with it any of its designs can be solved again.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    pub solve: SolveOptions,
    /// As `Study` has them.
    pub in_common: InCommon,
    /// `None` where a list of designs has the loads.
    pub load: Option<&'static str>,
}

impl Asked {
    /// Reads a config's text without the list of designs that it may name; `path` is what complaints call it.
    pub fn from_text(path: &Path, text: &str) -> Result<Asked, Error> {
        let source = Source::new(path.to_path_buf(), text.to_string());
        let document = source.parse()?;
        let root = source.root(&document);
        let default = Ok((SolveOptions::default(), true));
        let (solve, _) = root.section("solve")?.map_or(default, |table| read_solve(&table))?;
        let in_common = match root.section("joint")? {
            Some(joint) => Recipe::read(&joint, read_sampling(&root)?)?.in_common(),
            None => InCommon::default(),
        };
        let load = root.section("load")?;
        let load =
            load.and_then(|load| LOADS.map(|(key, ..)| key).into_iter().find(|key| load.find(key).is_some()));
        Ok(Asked { solve, in_common, load })
    }
}

fn read_solve(table: &Section) -> Result<(SolveOptions, bool), Error> {
    table.allow(&["accuracy", "method", "interpolation"])?;
    let mut solve = SolveOptions::default();
    if let Some(item) = table.find("accuracy") {
        solve.accuracy = match item.number()? {
            Some(number) => number,
            None => {
                let text = item.string().map_err(|_| item.wrong_type("a fraction like \"1 %\" or 0.01"))?;
                units::parse_percentage(text).map_err(|problem| item.refuse(&problem))?
            }
        };
        if !(solve.accuracy > 0.0 && solve.accuracy < 1.0) {
            return Err(item.refuse("must be above 0 and below 1 (100 %)"));
        }
    }
    if let Some(item) = table.find("method") {
        solve.method = MethodChoice::ALL[item.word(&MethodChoice::ALL.map(MethodChoice::name))?];
    }
    let interpolation = match table.find("interpolation") {
        None => true,
        Some(item) => item.word(&["auto", "off"])? == 0,
    };
    Ok((solve, interpolation))
}

fn read_sampling(root: &Section) -> Result<Scheme, Error> {
    root.section("sampling")?.map_or(Ok(Scheme::Grid), |table| read_scheme(&table))
}

fn read_scheme(table: &Section) -> Result<Scheme, Error> {
    table.allow(&["method", "count", "seed"])?;
    let method = match table.find("method") {
        None => 0,
        Some(item) => item.word(&Scheme::NAMES)?,
    };
    if method < 2 {
        for key in ["count", "seed"] {
            if let Some(item) = table.find(key) {
                let name = Scheme::NAMES[method];
                return Err(item.error(format!("{name} has no {key}; lists and counted ranges say it all")));
            }
        }
        return Ok(if method == 0 { Scheme::Grid } else { Scheme::Zip });
    }
    let count = table.need("count")?.whole(1, MAX_DESIGNS)?;
    let seed = table.find("seed").map_or(Ok(0), |item| item.whole(0, i64::MAX as u64))?;
    Ok(if method == 2 { Scheme::LatinHypercube { count, seed } } else { Scheme::Sobol { count, seed } })
}

type MakeLoad = fn(f64) -> Load;

/// The kinds of load: key, dimension of its values, and what it makes of one.
const LOADS: [(&str, Dimension, MakeLoad); 3] = [
    ("indentation", Dimension::Length, Load::Indentation),
    ("offset", Dimension::Length, Load::Offset),
    ("force", Dimension::Force, Load::Force),
];

fn read_load(table: &Section, recipe: &Recipe) -> Result<Vec<Load>, Error> {
    table.allow(&LOADS.map(|(key, ..)| key))?;
    let mut given = LOADS.into_iter().filter_map(|load| Some((table.find(load.0)?, load)));
    let Some((item, (key, dimension, make))) = given.next() else {
        return Err(table.error("one of `indentation`, `offset` and `force` is needed".to_string()));
    };
    if let Some((item, _)) = given.next() {
        return Err(item.error(format!("`{key}` is given, too; only one kind of load is allowed")));
    }
    if key == "indentation" && recipe.has_press_fits() {
        let problem =
            "press fits (a radial clearance below zero) have no indentation; give `offset` or `force`";
        return Err(item.error(problem));
    }
    let values = Values::read(&item, Some(dimension), Limits::NOT_NEGATIVE, Counts::Required)?;
    let count = values.count().unwrap_or(1);
    if count > MAX_STEPS {
        return Err(item.error(format!("{count} load steps; at most {MAX_STEPS} are allowed")));
    }
    Ok((0..count).map(|step| make(values.at(Pick::Index(step)))).collect())
}

fn read_list(table: &Section, config: &Path) -> Result<DesignsFile, Error> {
    table.allow(&["file"])?;
    let item = table.need("file")?;
    let folder = config.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let path = folder.join(item.string()?);
    if !path.is_file() {
        return Err(item.refuse(&format!("there is no file {}", path.display())));
    }
    DesignsFile::open(path)
}
