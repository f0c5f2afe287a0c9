//! Several sites in one chain: `[defaults]` for all of them, `[[site]]` for each.
//!
//! ```toml
//! [defaults.tracker]        # any table of a site
//! association = "pda"
//!
//! [[site]]
//! name = "north"
//! position = { latitude_deg = 50.45, longitude_deg = 30.52, height_m = 120.0 }
//! source = "radar-sim"
//! radar = { scan_period_s = 1.0 }
//! ```
//!
//! The single form, a table `[site]` with the tables of the site at the top, is a chain of one site.

use std::path::Path;

use toml::{Table, Value};

use super::{ChainConfig, Source};
use crate::latency_log;

use super::load::{ConfigError, apply, read, read_text, require};

/// Tables that belong to a site; all others are common to the chain.
const TABLES_OF_SITE: [&str; 8] =
    ["radar", "extractor", "tracker", "plot_source", "fusion", "link", "replay", "budget"];
/// The other keys of a site.
const KEYS_OF_SITE: [&str; 4] = ["name", "sac", "sic", "position"];

/// The configuration of a chain, site by site. There is at least one site; what is common to the chain is equal in all.
#[derive(Debug, Clone, PartialEq)]
pub struct Sites {
    sites: Vec<ChainConfig>,
}

impl Sites {
    /// The chain of one site.
    pub fn one(site: ChainConfig) -> Self {
        Self { sites: vec![site] }
    }

    /// The chain of these sites: those of one run, as it was recorded.
    ///
    /// # Errors
    /// [`ConfigError::Range`]: there is none, or two have one name.
    pub fn several(sites: Vec<ChainConfig>) -> Result<Self, ConfigError> {
        require("site", "none", !sites.is_empty(), "at least one")?;
        let sites = Self { sites };
        check_names(&sites)?;
        Ok(sites)
    }

    /// All sites.
    pub fn all(&self) -> &[ChainConfig] {
        &self.sites
    }

    /// The first site, for what is common to the chain.
    pub fn first(&self) -> &ChainConfig {
        &self.sites[0]
    }

    /// The only site, if there is one.
    pub fn only(&self) -> Option<&ChainConfig> {
        (self.sites.len() == 1).then(|| &self.sites[0])
    }

    /// The site of this name.
    ///
    /// # Errors
    /// [`ConfigError::Range`] that names the sites there are.
    pub fn named(&self, name: &str) -> Result<&ChainConfig, ConfigError> {
        let names = self.names().join(", ");
        let found = self.sites.iter().find(|site| site.site.name == name);
        require("site", name, found.is_some(), &format!("one of {names}"))?;
        Ok(found.unwrap_or(&self.sites[0]))
    }

    /// Names of the sites.
    pub fn names(&self) -> Vec<&str> {
        self.sites.iter().map(|site| site.site.name.as_str()).collect()
    }

    /// The logs of latencies, site by site, where a soak has them written.
    pub fn latency_logs(&self) -> Vec<String> {
        let of_site = |site: &ChainConfig| match (&site.soak.log, self.only()) {
            (log, _) if log.is_empty() => None,
            (log, Some(_)) => Some(log.clone()),
            (log, None) => Some(latency_log::of_site(log, &site.site.name)),
        };
        self.sites.iter().filter_map(of_site).collect()
    }

    /// Changes what is common to the chain, in all sites.
    pub fn change(&mut self, change: impl Fn(&mut ChainConfig)) {
        self.sites.iter_mut().for_each(change);
    }

    /// The configuration as TOML, complete: in the single form for one site.
    pub fn to_toml(&self) -> String {
        if let Some(only) = self.only() {
            return only.to_toml();
        }
        let table = |site: &ChainConfig| Table::try_from(site).expect("a checked configuration can be written as TOML");
        let mut common = table(self.first());
        common.retain(|key, _| key != "site" && !TABLES_OF_SITE.contains(&key));
        let without_source = |run: &mut Value| run.as_table_mut().and_then(|run| run.remove("source"));
        common.get_mut("run").and_then(without_source);
        let of_site = |site: &ChainConfig| {
            let mut table = table(site);
            let source = table.get_mut("run").and_then(without_source);
            let Some(Value::Table(mut own)) = table.remove("site") else { return Value::Table(Table::new()) };
            own.extend(source.map(|source| ("source".to_string(), source)));
            own.extend(table.into_iter().filter(|(key, _)| TABLES_OF_SITE.contains(&key.as_str())));
            Value::Table(own)
        };
        common.insert("site".into(), Value::Array(self.sites.iter().map(of_site).collect()));
        toml::to_string(&common).expect("a table can be written as TOML")
    }
}

/// Reads the configuration of one site from `path` (defaults alone without one), applies `overrides` of the form
/// `table.key=value`, checks.
///
/// # Errors
/// [`ConfigError`], naming the file, key or value and what was expected; the file is of several sites.
pub fn load(path: Option<&Path>, overrides: &[String]) -> Result<ChainConfig, ConfigError> {
    only(&load_sites(path, overrides)?)
}

/// A configuration that there is already, with `overrides` applied and checked.
///
/// # Errors
/// As [`load`].
pub fn adjust(config: &ChainConfig, overrides: &[String]) -> Result<ChainConfig, ConfigError> {
    parse(Path::new("recorded configuration"), &config.to_toml(), overrides)
}

/// As [`load`], from the text of a file; `path` is for messages.
///
/// # Errors
/// As [`load`].
pub fn parse(path: &Path, text: &str, overrides: &[String]) -> Result<ChainConfig, ConfigError> {
    only(&parse_sites(path, text, overrides)?)
}

/// The configuration of one site as its recording holds it, whatever other sites the chain had; `path` is for messages.
///
/// # Errors
/// As [`load`].
pub fn parse_recorded(path: &Path, text: &str) -> Result<ChainConfig, ConfigError> {
    let site = read(&path.display().to_string(), table_of(path, text)?)?;
    site.check()?;
    Ok(site)
}

fn only(sites: &Sites) -> Result<ChainConfig, ConfigError> {
    let count = sites.all().len();
    require("site", format!("{count} sites"), count == 1, &format!("one of {} (--site)", sites.names().join(", ")))?;
    Ok(sites.first().clone())
}

/// Reads `path` (defaults alone without one), applies `overrides` of the form `table.key=value`, checks. An override of a
/// site's key counts for all sites; `site.NAME.table.key=value` for one.
///
/// # Errors
/// [`ConfigError`], naming the file, key or value and what was expected.
pub fn load_sites(path: Option<&Path>, overrides: &[String]) -> Result<Sites, ConfigError> {
    let text = read_text(path)?;
    let mut sites = parse_sites(path.unwrap_or(Path::new("defaults")), &text, overrides)?;
    if let Some(folder) = path.and_then(Path::parent) {
        sites.change(|site| site.sim.find_flights(folder));
    }
    Ok(sites)
}

/// As [`load_sites`], from the text of a file; `path` is for messages.
///
/// # Errors
/// [`ConfigError`], naming the file, key or value and what was expected.
pub fn parse_sites(path: &Path, text: &str, overrides: &[String]) -> Result<Sites, ConfigError> {
    let mut table = table_of(path, text)?;
    let place = path.display().to_string();
    let several = matches!(table.get("site"), Some(Value::Array(_)));
    let (of_defaults, others): (Vec<_>, Vec<_>) =
        overrides.iter().partition(|argument| several && argument.starts_with("defaults."));
    for argument in of_defaults {
        apply(&mut table, argument)?;
    }
    let mut tables = if several { split(&place, table)? } else { vec![(String::new(), table)] };
    let place_of = |name: &str| if several { format!("{place}, site `{name}`") } else { place.clone() };
    for (name, table) in &tables {
        read(&place_of(name), table.clone())?; // a mistake in the file is reported as one of the file
    }
    let names: Vec<String> = tables.iter().map(|(name, _)| name.clone()).collect();
    for argument in others {
        let of_one = names.iter().find_map(|name| Some((name, argument.strip_prefix(&format!("site.{name}."))?)));
        for (name, table) in &mut tables {
            match of_one {
                Some((wanted, rest)) if several && wanted == name => apply(table, rest)?,
                Some(_) if several => continue,
                _ => apply(table, argument)?,
            }
            read(&format!("--set {argument}"), table.clone())?;
        }
    }
    let mut sites = Vec::with_capacity(tables.len());
    for (name, table) in tables {
        let site = read(&place_of(&name), table)?;
        site.check()?;
        sites.push(site);
    }
    let mut sites = Sites { sites };
    check_together(&sites)?;
    let origin = sites.first().site.position;
    if several {
        sites.change(|site| site.sim.origin = site.sim.origin.or(origin));
    }
    if sites.all().iter().any(|site| site.run.source == Source::Fusion) {
        sites.change(|site| site.run.fused = site.run.source != Source::Fusion);
    }
    Ok(sites)
}

fn table_of(path: &Path, text: &str) -> Result<Table, ConfigError> {
    toml::from_str(text).map_err(|error| ConfigError::Syntax {
        path: path.to_path_buf(),
        message: error.to_string().lines().map(shortened).collect::<Vec<_>>().join(" "),
    })
}

/// The table of each site with its name, from a file with `[[site]]`.
fn split(place: &str, mut table: Table) -> Result<Vec<(String, Table)>, ConfigError> {
    let refuse =
        |key: String, message: &str| ConfigError::Key { place: place.to_string(), key, message: message.into() };
    let Some(Value::Array(sites)) = table.remove("site") else { return Ok(Vec::new()) };
    let defaults = match table.remove("defaults") {
        None => Table::new(),
        Some(Value::Table(defaults)) => defaults,
        Some(_) => return Err(refuse("defaults".into(), "expected a table")),
    };
    if let Some(key) = table.keys().find(|key| TABLES_OF_SITE.contains(&key.as_str())) {
        return Err(refuse(key.clone(), "with [[site]] it stands under [defaults] or in a site"));
    }
    let is_of_site = |key: &String| TABLES_OF_SITE.contains(&key.as_str());
    if let Some(key) = defaults.keys().find(|key| !is_of_site(key)) {
        return Err(refuse(format!("defaults.{key}"), &format!("expected one of {}", TABLES_OF_SITE.join(", "))));
    }
    if sites.is_empty() {
        return Err(refuse("site".into(), "expected at least one site"));
    }
    let mut tables: Vec<(String, Table)> = Vec::new();
    for (index, site) in sites.into_iter().enumerate() {
        let Value::Table(site) = site else { return Err(refuse(format!("site[{index}]"), "expected a table")) };
        let Some(Value::String(name)) = site.get("name").cloned() else {
            return Err(refuse(format!("site[{index}].name"), "expected the name of the site"));
        };
        let mut own = table.clone();
        for (key, value) in &defaults {
            merge(&mut own, key, value);
        }
        let mut identity = Table::new();
        for (key, value) in &site {
            match key.as_str() {
                "source" => {
                    let run = own.entry("run").or_insert_with(|| Value::Table(Table::new()));
                    if let Value::Table(run) = run {
                        run.insert("source".into(), value.clone());
                    }
                }
                key if KEYS_OF_SITE.contains(&key) => drop(identity.insert(key.into(), value.clone())),
                key if TABLES_OF_SITE.contains(&key) => merge(&mut own, key, value),
                key => {
                    let known = [&KEYS_OF_SITE[..], &["source"], &TABLES_OF_SITE[..]].concat().join(", ");
                    return Err(refuse(format!("site[{index}].{key}"), &format!("expected one of {known}")));
                }
            }
        }
        own.insert("site".into(), Value::Table(identity));
        tables.push((name, own));
    }
    Ok(tables)
}

/// Puts `value` into `table`, key by key where both are tables.
fn merge(table: &mut Table, key: &str, value: &Value) {
    match (table.get_mut(key), value) {
        (Some(Value::Table(present)), Value::Table(more)) => {
            more.iter().for_each(|(key, value)| merge(present, key, value));
        }
        _ => drop(table.insert(key.to_string(), value.clone())),
    }
}

fn check_names(sites: &Sites) -> Result<(), ConfigError> {
    sites.all().iter().enumerate().try_for_each(|(index, site)| {
        let name = &site.site.name;
        let taken = sites.all()[..index].iter().any(|other| other.site.name == *name);
        require(&format!("site[{index}].name"), name, !taken, "a name that no other site has")
    })
}

/// Checks what only several sites together can break.
fn check_together(sites: &Sites) -> Result<(), ConfigError> {
    check_names(sites)?;
    for (index, site) in sites.all().iter().enumerate() {
        let placed = site.site.position.is_some() || sites.only().is_some();
        let simulated = site.run.source == Source::RadarSim;
        require(
            &format!("site[{index}].position"),
            "not given",
            placed || !simulated,
            "a position: all see the same targets",
        )?;
        let is_fused = sites.all().iter().any(|other| other.run.source == Source::Fusion);
        let placed = site.site.position.is_some() || !is_fused;
        require(&format!("site[{index}].position"), "not given", placed, "a position: its tracks are fused")?;
    }
    let fusions = sites.all().iter().filter(|site| site.run.source == Source::Fusion).count();
    let found = format!("{fusions} sites of {} with `fusion`", sites.all().len());
    let valid = fusions == 0 || fusions == 1 && sites.all().len() > 1;
    require("run.source", found, valid, "at most one, beside sites whose tracks it fuses")
}

/// The beginning of a line that may be any length.
fn shortened(line: &str) -> String {
    const LONGEST: usize = 200;
    if line.chars().count() <= LONGEST {
        line.to_string()
    } else {
        line.chars().take(LONGEST).chain("…".chars()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error_of(text: &str, overrides: &[&str]) -> String {
        let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
        parse(Path::new("x.toml"), text, &overrides).expect_err("must be refused").to_string()
    }

    const TWO: &str = r#"
[run]
scans = 7
[defaults.tracker]
start_speed_mps = 90.0
[defaults.radar]
ranges = 100
[[site]]
name = "north"
position = { latitude_deg = 50.0, longitude_deg = 30.0, height_m = 100.0 }
radar = { scan_period_s = 2.0 }
[[site]]
name = "south"
sic = 9
source = "plot-source"
"#;

    fn parse_text(text: &str, overrides: &[&str]) -> Result<Sites, ConfigError> {
        let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
        parse_sites(Path::new("x.toml"), text, &overrides)
    }

    #[test]
    fn sites_share_defaults_and_what_belongs_to_the_chain() {
        let sites = parse_text(TWO, &["run.scans=9", "extractor.pfa=1e-4", "site.south.tracker.start_speed_mps=50.0"])
            .expect("valid");
        let [north, south] = sites.all() else { panic!("two sites") };
        assert_eq!((north.run.scans, south.run.scans), (9, 9));
        assert_eq!((north.radar.ranges, north.radar.scan_period_s, south.radar.ranges), (100, 2.0, 100));
        assert_eq!((north.tracker.start_speed_mps, south.tracker.start_speed_mps), (90.0, 50.0));
        assert_eq!((north.extractor.pfa, south.extractor.pfa), (1e-4, 1e-4));
        assert_eq!((south.site.sic, south.run.source), (Some(9), super::super::Source::PlotSource));
        assert_eq!(south.sim.origin, north.site.position);
    }

    #[test]
    fn the_effective_configuration_of_several_sites_reads_back_as_itself() {
        let sites = parse_text(TWO, &[]).expect("valid");
        assert_eq!(parse_text(&sites.to_toml(), &[]).expect("valid"), sites);
        let one = parse_text("[site]\nname = \"a\"", &[]).expect("valid");
        assert!(one.only().is_some() && parse_text(&one.to_toml(), &[]).expect("valid") == one);
    }

    #[test]
    fn mistakes_name_the_site_and_the_key() {
        let error = |text: &str, overrides: &[&str]| parse_text(text, overrides).expect_err("refused").to_string();
        let with = |more: &str| format!("{TWO}{more}");
        assert!(error(&with("colour = 3"), &[]).contains("key `site[1].colour`: expected one of name, sac"));
        assert!(error(&with("[[site]]\nname = \"north\""), &[]).contains("site[2].name` is north"));
        assert!(error(&with("[tracker]\n"), &[]).contains("key `tracker`: with [[site]] it stands under [defaults]"));
        assert!(error(&with("[site.tracker]\nspeed = 1"), &[]).contains("x.toml, site `south`: key `tracker.speed`"));
        let error = parse_text(TWO, &[]).expect("valid").named("east").expect_err("none").to_string();
        assert_eq!(error, "key `site` is east, expected one of north, south");
    }

    #[test]
    fn an_unknown_key_is_named() {
        let message = error_of("[extractor]\npfaa = 1e-6\n", &[]);
        assert!(message.starts_with("x.toml: key `extractor.pfaa`: unknown field"), "{message}");
        assert!(!message.contains('\n'));
        let message = error_of("", &["--", "x"]);
        assert!(message.contains("expected table.key=value"), "{message}");
    }

    #[test]
    fn a_negative_count_is_named() {
        let message = error_of("[radar]\nranges = -3\n", &[]);
        assert!(message.starts_with("x.toml: key `radar.ranges`: invalid value: integer `-3`"), "{message}");
        let message = error_of("", &["radar.ranges=0"]);
        assert!(message.starts_with("key `radar.ranges` is 0, expected a whole number from"), "{message}");
    }

    #[test]
    fn an_override_wins_over_the_file_and_may_be_bare_text() {
        let config = parse(
            Path::new("x.toml"),
            "[site]\nname = \"a\"\n[extractor]\npfa = 1e-3\n",
            &["site.name=b".into(), "extractor.pfa=1e-4".into()],
        )
        .expect("valid");
        assert_eq!(config.site.name, "b");
        assert!((config.extractor.pfa - 1e-4).abs() < 1e-18);
    }

    #[test]
    fn the_effective_configuration_reads_back_as_itself() {
        let config = load(None, &[]).expect("defaults are valid");
        let again = parse(Path::new("x.toml"), &config.to_toml(), &[]).expect("valid");
        assert_eq!(config, again);
    }
}
