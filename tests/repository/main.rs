//! What is committed besides the program - pages, results, pictures - is what the program of today says and makes.

#[path = "../common"]
mod common {
    pub mod random;
    pub mod draws;
}
mod documentation;
mod results;
mod recorded_choices;
mod study_figures;
