//! Parser of the lines of micro-steps.

#[derive(Default)]
pub(crate) struct Line<'a> {
    pub time: &'a str,
    /// `-` for none.
    pub event: &'a str,
    pub selected: Vec<&'a str>,
    pub preempted: Vec<&'a str>,
    pub held: Vec<&'a str>,
    pub exits: Vec<&'a str>,
    pub taken: &'a str,
    pub effects: bool,
    pub entries: Vec<&'a str>,
    pub reads: Vec<&'a str>,
}

pub(crate) fn lines(log: &[String]) -> Vec<Line<'_>> {
    log.iter().filter_map(|text| line(text)).collect()
}

fn line(text: &str) -> Option<Line<'_>> {
    if text.starts_with(' ') {
        return None;
    }
    let mut parts = text.split("; ");
    let head = parts.next()?;
    let (time, rest) = head.split_once(" s ")?;
    let (event, selected) = rest.split_once(": ").unwrap_or((rest, ""));
    let mut line = Line { time, event, ..Line::default() };
    if !["dropped", "nothing", ""].contains(&selected) {
        line.selected = selected.split(", ").collect();
    }
    for part in parts {
        let (title, rest) = part.split_once(' ')?;
        let items = || rest.split(", ").collect();
        match title {
            "preempt" => line.preempted = items(),
            "hold" => line.held = items(),
            "exit" => line.exits = items(),
            "then" => line.taken = rest,
            "do" => line.effects = true,
            "enter" => line.entries = items(),
            "read" => line.reads = items(),
            _ => {}
        }
    }
    Some(line)
}
