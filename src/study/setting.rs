//! "joint.plate.youngs_modulus=70 GPa": one value of a config, set beside its file.

use toml_edit::{DocumentMut, InlineTable, Item, Key, Table, TableLike, Value};

use crate::error::{Error, shortened};

/// A dotted key and the value that it is to have.
#[derive(Clone, Debug)]
pub struct Setting {
    keys: Vec<String>,
    value: Value,
    /// What complaints say in the place of a file: how it was given.
    pub place: &'static str,
}

impl Setting {
    /// From "key=value": the key dotted as in TOML, the value as TOML or, where it is none, the text itself.
    /// `place` is what complaints say in the place of a file.
    pub fn parse(text: &str, place: &'static str) -> Result<Setting, Error> {
        let refuse = |problem: &str| Err(complaint(place, &shortened(text), problem.to_string()));
        let Some((key, value)) = text.split_once('=') else {
            return refuse("a key and its value are needed, like solve.accuracy=0.1%");
        };
        let keys = match Key::parse(key.trim()) {
            Ok(keys) if !keys.is_empty() => keys.iter().map(|key| key.get().to_string()).collect(),
            _ => return refuse("the key before `=` is none; it is written like joint.plate.youngs_modulus"),
        };
        let value = value.trim();
        let value = match value.parse::<Value>() {
            Ok(value) => value,
            // Who begins like this means TOML.
            Err(error) if value.starts_with(['[', '{', '"', '\'']) => {
                let problem = error.message().trim().replace('\n', ", ");
                return refuse(&format!("the value is not valid TOML: {problem}"));
            }
            Err(_) => Value::from(value),
        };
        Ok(Setting { keys, value, place })
    }

    /// The dotted key, as complaints about a config have it.
    pub fn key(&self) -> String {
        self.keys.join(".")
    }

    /// Puts the value in the place of what the document has there; tables that are missing are made. Returns the dotted key of what was not
    /// there before, be it a table or the value, or of the value that was.
    pub fn apply(&self, document: &mut DocumentMut) -> Result<String, Error> {
        let (last, above) = self.keys.split_last().expect("a setting has a key");
        let mut made = None;
        let mut table: &mut dyn TableLike = document.as_table_mut();
        // Inside an inline table only inline tables can be.
        let mut is_inline = false;
        let mut above = above.iter();
        let mut dotted = String::new();
        while let Some(key) = above.next() {
            dotted += if dotted.is_empty() { "" } else { "." };
            dotted += key;
            let refuse = |problem: String| Err(complaint(self.place, &self.key(), problem));
            if !table.contains_key(key) {
                if let Some(number) = above.clone().next().filter(|next| next.parse::<usize>().is_ok()) {
                    return refuse(format!("`{dotted}` has no table; there is no number {number}"));
                }
                made.get_or_insert_with(|| dotted.clone());
            }
            let item = table.entry(key).or_insert_with(|| new_table(is_inline));
            is_inline = item.is_inline_table() || item.is_array();
            if item.is_array_of_tables() || item.is_array() {
                // Tables of a list are numbered from 1.
                let Some(number) = above.next() else {
                    return refuse(format!("`{dotted}` is a list: a number must follow, and a key"));
                };
                let count = table_count(item);
                table = match numbered(item, number) {
                    Some(table) => table,
                    None => {
                        let tables = match count {
                            0 => "no table".to_string(),
                            1 => "only 1 table".to_string(),
                            count => format!("only {count} tables"),
                        };
                        return refuse(format!("`{dotted}` has {tables}; there is no number {number}"));
                    }
                };
                dotted = format!("{dotted}.{number}");
                continue;
            }
            table = match item.as_table_like_mut() {
                Some(table) => table,
                None => return refuse(format!("`{dotted}` is a value, not a table")),
            };
        }
        let mut value = self.value.clone();
        match table.get_mut(last).and_then(Item::as_value_mut) {
            Some(old) => {
                // Blanks and the comment behind an old value stay where they are.
                *value.decor_mut() = old.decor().clone();
                *old = value;
            }
            None => _ = table.insert(last, Item::Value(value)),
        }
        Ok(made.unwrap_or_else(|| self.key()))
    }
}

/// A table of a list of tables by its number, from 1.
fn numbered<'a>(list: &'a mut Item, number: &str) -> Option<&'a mut dyn TableLike> {
    let place = number.parse::<usize>().ok()?.checked_sub(1)?;
    match list {
        Item::ArrayOfTables(tables) => tables.get_mut(place).map(|table| table as &mut dyn TableLike),
        Item::Value(Value::Array(values)) => {
            let table = values.get_mut(place)?.as_inline_table_mut()?;
            Some(table as &mut dyn TableLike)
        }
        _ => None,
    }
}

fn table_count(list: &Item) -> usize {
    match list {
        Item::ArrayOfTables(tables) => tables.len(),
        Item::Value(Value::Array(values)) => values.iter().filter(|value| value.is_inline_table()).count(),
        _ => 0,
    }
}

fn new_table(is_inline: bool) -> Item {
    if is_inline {
        return Item::Value(Value::InlineTable(InlineTable::new()));
    }
    let mut table = Table::new();
    // No header of its own where it has only tables.
    table.set_implicit(true);
    Item::Table(table)
}

fn complaint(place: &str, key: &str, problem: String) -> Error {
    Error::Input { file: place.into(), line: None, key: key.to_string(), problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(text: &str, settings: &[&str]) -> String {
        let mut document: DocumentMut = text.parse().unwrap();
        for setting in settings {
            Setting::parse(setting, "--set").unwrap().apply(&mut document).unwrap();
        }
        document.to_string()
    }

    #[test]
    fn a_value_takes_the_place_of_the_old_one_and_all_else_stays() {
        let text =
            "# my joint\n[joint]\nplate = { model = \"annulus\" } # held\nthickness   = \"5 mm\" # thin\n";
        assert_eq!(
            set(text, &["joint.thickness=6 mm", "joint.plate.model = block"]),
            "# my joint\n[joint]\nplate = { model = \"block\" } # held\nthickness   = \"6 mm\" # thin\n"
        );
    }

    #[test]
    fn what_is_missing_is_made() {
        assert_eq!(
            set("title = \"t\"\n", &["solve.accuracy=0.1%"]),
            "title = \"t\"\n\n[solve]\naccuracy = \"0.1%\"\n"
        );
        let pin = set("joint = { thickness = \"5 mm\" }\n", &["joint.pin.poissons_ratio=0.3"]);
        assert_eq!(pin, "joint = { thickness = \"5 mm\" , pin = { poissons_ratio = 0.3 } }\n");
        let table = toml::from_str::<toml::Table>(&pin).unwrap();
        assert_eq!(table["joint"]["pin"]["poissons_ratio"].as_float(), Some(0.3));
    }

    #[test]
    fn what_was_not_there_is_told() {
        let made = |text: &str, setting: &str| {
            let mut document: DocumentMut = text.parse().unwrap();
            Setting::parse(setting, "--set").unwrap().apply(&mut document).map_err(|error| error.to_string())
        };
        let text = "[joint]\nthickness = \"5 mm\"\n";
        assert_eq!(made(text, "joint.thickness=6 mm").unwrap(), "joint.thickness");
        assert_eq!(made(text, "joint.pin.tube.model=x").unwrap(), "joint.pin");
        assert_eq!(made(text, "sampling.method=sobol").unwrap(), "sampling");
        let refused = made(text, "joint.pin.layers.1.thickness=2 mm").unwrap_err();
        assert!(refused.ends_with("`joint.pin.layers` has no table; there is no number 1"), "{refused}");
    }

    #[test]
    fn tables_of_a_list_are_numbered() {
        let text =
            "[[joint.pin.layers]]\nthickness = \"1 mm\"\n\n[[joint.pin.layers]]\nthickness = \"2 mm\"\n";
        assert_eq!(set(text, &["joint.pin.layers.2.thickness=3 mm"]), text.replace("2 mm", "3 mm"));
        let inline = "joint = { pin = { layers = [{ thickness = \"1 mm\" }] } }\n";
        assert_eq!(set(inline, &["joint.pin.layers.1.thickness=3 mm"]), inline.replace("1 mm", "3 mm"));
    }

    #[test]
    fn values_are_toml_or_text() {
        for (value, written) in [
            ("70 GPa", "\"70 GPa\""),
            ("\"70 GPa\"", "\"70 GPa\""),
            ("0.01", "0.01"),
            ("0.1%", "\"0.1%\""),
            ("plane-strain", "\"plane-strain\""),
            ("[\"1 N\", \"2 N\"]", "[\"1 N\", \"2 N\"]"),
            ("{ from = \"1 N\", to = \"2 N\", count = 2 }", "{ from = \"1 N\", to = \"2 N\", count = 2 }"),
            ("a = b", "\"a = b\""),
        ] {
            assert_eq!(set("", &[&format!("x={value}")]), format!("x = {written}\n"), "{value}");
        }
    }

    #[test]
    fn what_is_no_setting_is_refused() {
        for (text, problem) in [
            ("joint", "--set: joint: a key and its value are needed"),
            ("=5", "--set: =5: the key before `=` is none"),
            ("a..b=5", "the key before `=` is none"),
            ("a b=5", "the key before `=` is none"),
            ("a=[1, 2", "--set: a=[1, 2: the value is not valid TOML: "),
        ] {
            let said = Setting::parse(text, "--set").unwrap_err().to_string();
            assert!(said.contains(problem), "{text}: {said}");
        }
        let mut document: DocumentMut = "title = \"t\"\n".parse().unwrap();
        let mut layers: DocumentMut = "[[joint.pin.layers]]\nthickness = 1\n".parse().unwrap();
        for (key, problem) in [
            ("joint.pin.layers.2.thickness", "`joint.pin.layers` has only 1 table; there is no number 2"),
            ("joint.pin.layers.thickness", "`joint.pin.layers` is a list: a number must follow, and a key"),
        ] {
            let said = Setting::parse(&format!("{key}=2"), "--set").unwrap().apply(&mut layers).unwrap_err();
            assert_eq!(said.to_string(), format!("--set: {key}: {problem}"));
        }
        let said =
            Setting::parse("title.x=1", "--set").unwrap().apply(&mut document).unwrap_err().to_string();
        assert_eq!(said, "--set: title.x: `title` is a value, not a table");
    }
}
