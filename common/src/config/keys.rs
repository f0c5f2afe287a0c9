//! The keys of the configuration and what they mean, from the types and their doc comments.

use std::collections::BTreeMap;

use schemars::Schema;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value};

use super::ChainConfig;

/// What is known of a key or table.
#[derive(Debug, Clone, Default)]
pub(super) struct About {
    /// One line.
    pub(super) text: String,
    /// The values of a key, if it names them.
    pub(super) values: Vec<String>,
    /// Kind of the values of a key; empty for a table.
    pub(super) kind: String,
}

/// Keys and tables by their paths; those of the tables of an array follow the name of the array.
pub(super) type Keys = BTreeMap<String, About>;

/// Stands in paths for the name of a table that the user gives.
const NAME: &str = "NAME";

/// What is known of the key at `path`, in which a user's name may stand.
pub(super) fn about<'a>(keys: &'a Keys, path: &str) -> Option<&'a About> {
    let named = || {
        let (table, rest) = path.split_once('.')?;
        let key = rest.split_once('.').map_or(String::new(), |(_, key)| format!(".{key}"));
        keys.get(&format!("{table}.{NAME}{key}"))
    };
    keys.get(path).or_else(named)
}

/// All keys and tables.
pub(super) fn keys() -> Keys {
    let schema = SchemaSettings::draft2020_12().for_serialize().into_generator().into_root_schema_for::<ChainConfig>();
    let mut keys = Keys::new();
    if let Some(root) = schema.as_object() {
        describe(&schema, root, "", &mut keys);
    }
    keys
}

/// What a key may hold; `None` for a table or no key at all. Places in arrays are left out: `sim.targets[3].name`.
pub(super) fn expected(key: &str) -> Option<String> {
    let mut parts = key.split('[');
    let first = parts.next().unwrap_or_default().to_string();
    let path = parts.fold(first, |path, part| path + "[]" + part.split_once(']').map_or("", |(_, rest)| rest));
    let keys = keys();
    let about = about(&keys, &path).filter(|about| !about.kind.is_empty())?;
    Some(if about.values.is_empty() { about.kind.clone() } else { about.values.join(", ") })
}

/// Notes the keys of the table `object` at `path`.
fn describe(schema: &Schema, object: &Map<String, Value>, path: &str, keys: &mut Keys) {
    for (name, property) in object.get("properties").and_then(Value::as_object).into_iter().flatten() {
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        let Some(referred) = resolve(schema, property).as_object() else { continue };
        // The tag of a variant stands for what the variant is.
        let text = match referred.get("const") {
            Some(tag) => format!("`{tag}`: {}", text_of(object)),
            None => property.as_object().map(text_of).unwrap_or_default(),
        };
        let items = referred.get("items").map(|items| resolve(schema, items));
        let named = referred.get("additionalProperties").map(|named| resolve(schema, named));
        if let Some(named) = named.and_then(Value::as_object).filter(|named| named.contains_key("properties")) {
            let path = format!("{path}.{NAME}");
            keys.insert(path.clone(), About { text, ..About::default() });
            describe(schema, named, &path, keys);
        } else if let Some(items) = items.and_then(Value::as_object).filter(|items| items.contains_key("properties")) {
            let path = format!("{path}[]");
            keys.insert(path.clone(), About { text, ..About::default() });
            describe(schema, items, &path, keys);
        } else if referred.contains_key("properties") {
            keys.insert(path.clone(), About { text, ..About::default() });
            describe(schema, referred, &path, keys);
        } else if let Some(about) = keys.get_mut(&path) {
            // A key that several variants have.
            about.values.extend(values_of(referred));
            if referred.contains_key("const") {
                about.text = format!("{} {text}", about.text);
            }
        } else {
            keys.insert(path, About { text, values: values_of(referred), kind: kind_of(referred) });
        }
    }
    // The keys of a variant stand beside those that all have.
    for variant in object.get("oneOf").and_then(Value::as_array).into_iter().flatten() {
        if let Some(variant) = variant.as_object() {
            describe(schema, variant, path, keys);
        }
    }
}

/// The schema that `property` refers to, also as one of two where it may be left out.
fn resolve<'a>(schema: &'a Schema, property: &'a Value) -> &'a Value {
    let either = property.get("anyOf").and_then(|either| either.get(0));
    let property = either.unwrap_or(property);
    let name = property.get("$ref").and_then(Value::as_str).and_then(|path| path.rsplit('/').next());
    let referred = name.and_then(|name| schema.get("$defs").and_then(|all| all.get(name)));
    referred.unwrap_or(property)
}

/// The first paragraph of the description, in one line and without the marks of rustdoc.
fn text_of(schema: &Map<String, Value>) -> String {
    let text = schema.get("description").and_then(Value::as_str).unwrap_or_default();
    let paragraph = text.split("\n\n").next().unwrap_or_default();
    paragraph.replace('\n', " ").replace("\\[", "[").replace("\\]", "]").replace("[`", "`").replace("`]", "`")
}

/// The values that a schema names.
fn values_of(schema: &Map<String, Value>) -> Vec<String> {
    let named = schema.get("enum").and_then(Value::as_array).into_iter().flatten();
    let variants = schema.get("oneOf").and_then(Value::as_array).into_iter().flatten();
    let variants = variants.flat_map(|variant| match variant.get("enum").and_then(Value::as_array) {
        Some(several) => several.iter().collect(),
        None => variant.get("const").into_iter().collect::<Vec<_>>(),
    });
    let own = schema.get("const").into_iter();
    named.chain(variants).chain(own).filter(|value| value.is_string()).map(|value| format!("`{value}`")).collect()
}

/// Kind of the values of a key.
fn kind_of(schema: &Map<String, Value>) -> String {
    let kind = schema.get("type");
    let kind = kind.and_then(|kind| kind.as_str().or_else(|| kind.get(0).and_then(Value::as_str)));
    let end = |name: &str| schema.get(name).and_then(Value::as_u64);
    match (kind, end("minimum"), end("maximum")) {
        (Some("number"), ..) => "a number".into(),
        (Some("integer"), Some(from), Some(to)) => format!("a whole number from {from} to {to}"),
        (Some("integer"), Some(from), None) => format!("a whole number from {from}"),
        (Some("integer"), None, _) => "a whole number".into(),
        (Some("boolean"), ..) => "`true` or `false`".into(),
        (Some("array"), ..) => "a list".into(),
        _ => "text".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_has_a_meaning() {
        let silent: Vec<String> =
            keys().into_iter().filter(|(_, about)| about.text.is_empty()).map(|(path, _)| path).collect();
        assert!(silent.is_empty(), "without a doc comment: {silent:?}");
    }

    #[test]
    fn a_value_of_another_kind_is_answered_in_words() {
        let message = |text: &str| {
            super::super::parse(std::path::Path::new("x.toml"), text, &[]).expect_err("refused").to_string()
        };
        let target = "[[sim.targets]]\nname = \"a\"\nmotion = \"straight\"\nposition_m = [0.0, 0.0, 0.0]\nvelocity_mps = [0.0, 0.0, 0.0]\n";
        let swerling = message(&format!("{target}snr_db = 10.0\nswerling = 1\n"));
        assert!(swerling.ends_with("expected `\"0\"`, `\"I\"`, `\"III\"`"), "{swerling}");
        let scans = message("[run]\nscans = \"many\"\n");
        assert!(scans.contains("run.scans") && scans.ends_with("expected a whole number from 0"), "{scans}");
        let twice = message(&format!("{target}snr_db = 10.0\nswerling = \"I\"\n").repeat(2));
        assert!(twice.contains("a name that no other target has"), "{twice}");
    }
}
