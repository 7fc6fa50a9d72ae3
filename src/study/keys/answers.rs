//! The keys of `[select]` and `[reduce]`.

use super::{ConfigKey, key, words};
use crate::study::reduce::{DEFAULT_BEST, DEFAULT_BINS, MOST_BEST, MOST_BINS};

/// What is wanted in the place of all rows: docs/select.md has the language of the expressions.
pub fn answer_keys() -> [ConfigKey; 13] {
    const EXPRESSION: &str = "a column, or an expression of columns";
    const EXPRESSIONS: &str = "columns or expressions, one or a list of them; two or three in all";
    let best = format!("whole numbers from 1 to {MOST_BEST}");
    let bins = format!("whole numbers from 1 to {MOST_BINS}");
    let limit = |name, about, example, needed| {
        key("reduce.histogram", name, about, "as `of`", "a number with its unit", example).needed(needed)
    };
    [
        key(
            "select",
            "keep",
            "rows for which this holds are kept, others are not written and not counted",
            "-",
            "a condition",
            "\"peak_pressure < 400 MPa and tangent_stiffness > 2e5 N/mm\"",
        )
        .needed("needed in [select]"),
        key(
            "reduce",
            "statistics",
            "quantities whose count, extremes, mean and standard deviation are told, into statistics.csv",
            "-",
            "columns or expressions, one or a list of up to 50",
            "[\"force\", \"peak_pressure\"]",
        )
        .needed("none"),
        key(
            "reduce",
            "quantiles",
            "of the same quantities, to 0.05 %",
            "-",
            "numbers from 0 to 1, one or a list of up to 50",
            "[0.05, 0.5, 0.95]",
        )
        .needed("none"),
        key(
            "reduce.best",
            "by",
            "what the rows in best.csv are ranked by",
            "-",
            EXPRESSION,
            "\"tangent_stiffness / peak_pressure\"",
        )
        .needed("needed in [reduce.best]"),
        key("reduce.best", "count", "rows", "-", &best, "20").default(&DEFAULT_BEST.to_string()),
        key(
            "reduce.best",
            "order",
            "which value is the best",
            "-",
            &words(&["largest", "smallest"]),
            "\"smallest\"",
        )
        .default("\"largest\""),
        key(
            "reduce.pareto",
            "largest",
            "what is to be large in the rows of pareto.csv: no row is better in one of these and as good in \
             the others",
            "-",
            EXPRESSIONS,
            "\"tangent_stiffness\"",
        )
        .needed("none"),
        key(
            "reduce.pareto",
            "smallest",
            "what is to be small",
            "-",
            EXPRESSIONS,
            "[\"peak_pressure\", \"thickness\"]",
        )
        .needed("none"),
        key(
            "reduce.histogram",
            "of",
            "what is counted in the bins of histogram.csv",
            "-",
            EXPRESSION,
            "\"peak_pressure\"",
        )
        .needed("needed in [reduce.histogram]"),
        key("reduce.histogram", "bins", "bins", "-", &bins, "50").default(&DEFAULT_BINS.to_string()),
        key(
            "reduce.histogram",
            "spacing",
            "bins of equal width, or of equal ratio",
            "-",
            &words(&["linear", "log"]),
            "\"log\"",
        )
        .default("\"linear\""),
        limit("from", "where the first bin begins, beside `to`", "\"1 MPa\"", "the smallest value"),
        limit("to", "where the last bin ends, beside `from`", "\"1 GPa\"", "the largest value"),
    ]
}
