//! Pieces of the page.

use crate::output::chart::style::COLOURS;
use crate::output::chart::text::escaped;

pub fn section(title: &str, content: &str) -> String {
    format!("<section>\n<h2>{}</h2>\n{content}</section>\n", escaped(title))
}

pub fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escaped(text))
}

pub fn remark(text: &str) -> String {
    format!("<p class=\"faint\">{}</p>\n", escaped(text))
}

/// A chart with its caption, and below that what is to know of it.
pub fn figure(caption: &str, note: &str, svg: &str) -> String {
    let note = if note.is_empty() { String::new() } else { format!("<small>{}</small>", escaped(note)) };
    format!("<figure>\n<figcaption>{}{note}</figcaption>\n{svg}</figure>\n", escaped(caption))
}

pub fn charts(figures: &[String]) -> String {
    format!("<div class=\"charts\">\n{}</div>\n", figures.concat())
}

/// A cell of a table: words to the left, numbers to the right.
pub enum Cell {
    Words(String),
    Number(String),
    /// Text to paste.
    Code(String),
    /// With a swatch of a series' colour.
    Key(usize, String),
}

pub fn table(head: &[&str], rows: &[Vec<Cell>]) -> String {
    let is_word = |place: usize| {
        rows.first()
            .and_then(|row| row.get(place))
            .is_some_and(|cell| matches!(cell, Cell::Words(_) | Cell::Code(_)))
    };
    let cell = |(place, name): (usize, &&str)| {
        if is_word(place) { Cell::Words(name.to_string()) } else { Cell::Number(name.to_string()) }
    };
    let head: Vec<Cell> = head.iter().enumerate().map(cell).collect();
    table_of(&head, rows)
}

pub fn table_of(head: &[Cell], rows: &[Vec<Cell>]) -> String {
    let line = |cells: &[Cell], tag: &str| -> String {
        let cells: String = cells.iter().map(|cell| cell.html(tag)).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let body: String = rows.iter().map(|row| line(row, "td")).collect();
    format!(
        "<div class=\"wide\"><table>\n<thead>{}</thead>\n<tbody>\n{body}</tbody></table></div>\n",
        line(head, "th")
    )
}

impl Cell {
    fn html(&self, tag: &str) -> String {
        match self {
            Cell::Words(text) => format!("<{tag} class=\"words\">{}</{tag}>", escaped(text)),
            Cell::Number(text) => format!("<{tag}>{}</{tag}>", escaped(text)),
            Cell::Code(text) => format!("<{tag} class=\"words\"><code>{}</code></{tag}>", escaped(text)),
            Cell::Key(colour, text) => {
                let colour = colour % COLOURS + 1;
                let key = format!("<span class=\"key\" style=\"background:var(--s{colour})\"></span>");
                format!("<{tag}>{key}{}</{tag}>", escaped(text))
            }
        }
    }
}

/// A quantity as a row of big facts.
pub fn facts(all: &[(&str, String)]) -> String {
    let one = |(name, value): &(&str, String)| {
        format!("<div><dt>{}</dt><dd>{}</dd></div>\n", escaped(name), escaped(value))
    };
    format!("<dl class=\"facts\">\n{}</dl>\n", all.iter().map(one).collect::<String>())
}
