//! Edits a Cargo.toml as text, so that comments and layout are kept.

/// The first and last line of a generated block in a Cargo.toml.
const BLOCK_BEGIN: &str = "# statecharts, kept in step by `monas generate`";
const BLOCK_END: &str = "# end of the statecharts";

/// Puts lines into the generated block of a table. Each table of a manifest may have its own block.
pub(crate) fn with_block(manifest: &str, header: &str, lines: &[String]) -> String {
    let block = format!(
        "{BLOCK_BEGIN}\n{}{BLOCK_END}\n",
        lines.iter().map(|line| format!("{line}\n")).collect::<String>()
    );
    let header = format!("{header}\n");
    let is_header = |at: &usize| *at == 0 || manifest[..*at].ends_with('\n');
    let Some(at) = manifest.match_indices(&header).map(|(at, _)| at).find(is_header) else {
        return format!("{manifest}\n{header}{block}");
    };
    let (before, rest) = manifest.split_at(at + header.len());
    let (table, after) = rest.split_at(rest.find("\n[").map_or(rest.len(), |end| end + 1));
    if let Some((head, rest)) = table.split_once(&format!("{BLOCK_BEGIN}\n"))
        && let Some((_, tail)) = rest.split_once(&format!("{BLOCK_END}\n"))
    {
        return format!("{before}{head}{block}{tail}{after}");
    }
    format!("{before}{block}{rest}")
}

/// Adds the crates of a folder, such as `"statecharts/*"`, to the members of a workspace.
pub(crate) fn with_members(manifest: &str, members: &str) -> String {
    match manifest.split_once("members = [") {
        Some((before, after)) if !manifest.contains(members) => {
            format!("{before}members = [{members}, {after}")
        }
        Some(_) => manifest.to_owned(),
        None => manifest.replacen("[workspace]\n", &format!("[workspace]\nmembers = [{members}]\n"), 1),
    }
}

/// The lines of a table.
pub(crate) fn table<'a>(manifest: &'a str, header: &str) -> Option<&'a str> {
    let start = manifest.lines().position(|line| line.trim() == header)?;
    let from: usize = manifest.split_inclusive('\n').take(start + 1).map(str::len).sum();
    let rest = &manifest[from..];
    Some(&rest[..rest.find("\n[").map_or(rest.len(), |end| end + 1)])
}

/// The value of a key in a table, without quotes and without a comment behind it.
pub(crate) fn value<'a>(table: &'a str, key: &str) -> Option<&'a str> {
    table.lines().find_map(|line| {
        let rest = line.strip_prefix(key)?.trim_start();
        let text = rest.strip_prefix('=')?.trim();
        let quoted = text.strip_prefix('"').and_then(|text| text.split_once('"'));
        Some(quoted.map_or_else(|| text.split('#').next().unwrap_or(text).trim_end(), |(value, _)| value))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATECHART_MEMBERS: &str = "\"statecharts/*\"";

    #[test]
    fn a_block_is_made_once_and_kept_in_step() {
        let manifest = "[package]\nname = \"a\"\n\n[dependencies]\nb = \"1\"\n\n[lints]\n";
        let one = with_block(manifest, "[dependencies]", &["x = 1".into()]);
        assert!(
            one.contains(&format!("[dependencies]\n{BLOCK_BEGIN}\nx = 1\n{BLOCK_END}\nb = \"1\"\n")),
            "{one}"
        );
        let two = with_block(&one, "[dependencies]", &["x = 1".into(), "y = 2".into()]);
        assert_eq!(two, one.replace("x = 1\n", "x = 1\ny = 2\n"));
        assert_eq!(with_block(&two, "[dependencies]", &["x = 1".into()]), one);
    }

    #[test]
    fn two_tables_of_one_manifest_have_a_block_each() {
        let manifest = "[workspace.dependencies]\na = \"1\"\n\n[package]\nname = \"team\"\n\n[dependencies]\na.workspace = true\n";
        let one = with_block(manifest, "[workspace.dependencies]", &["x = { path = \"x\" }".into()]);
        let both = with_block(&one, "[dependencies]", &["x.workspace = true".into()]);
        let expected = format!(
            "[workspace.dependencies]\n{BLOCK_BEGIN}\nx = {{ path = \"x\" }}\n{BLOCK_END}\na = \"1\"\n\n[package]\nname = \"team\"\n\n\
             [dependencies]\n{BLOCK_BEGIN}\nx.workspace = true\n{BLOCK_END}\na.workspace = true\n"
        );
        assert_eq!(both, expected);
        assert_eq!(with_block(&both, "[dependencies]", &["x.workspace = true".into()]), expected);
        assert_eq!(with_block(&both, "[workspace.dependencies]", &["x = { path = \"x\" }".into()]), expected);
    }

    #[test]
    fn crates_become_members_once() {
        let one = with_members("[workspace]\nresolver = \"3\"\nmembers = [\"a\"]\n", STATECHART_MEMBERS);
        assert_eq!(one, "[workspace]\nresolver = \"3\"\nmembers = [\"statecharts/*\", \"a\"]\n");
        assert_eq!(with_members(&one, STATECHART_MEMBERS), one);
        assert_eq!(
            with_members("[workspace]\n", STATECHART_MEMBERS),
            "[workspace]\nmembers = [\"statecharts/*\"]\n"
        );
    }

    #[test]
    fn values_stand_in_their_table() {
        let manifest = "[a]\nteam = \"x\"\n\n[b]\nteam = \"y\"\n";
        assert_eq!(table(manifest, "[b]").and_then(|table| value(table, "team")), Some("y"));
        assert_eq!(table(manifest, "[a]").and_then(|table| value(table, "teams")), None);
        assert_eq!(value("team = \"z#1\" # the package", "team"), Some("z#1"));
        assert_eq!(value("publish = false # never", "publish"), Some("false"));
    }
}
