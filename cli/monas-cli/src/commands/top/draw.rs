//! Metrics on the whole terminal.

use monas_terminal::table::{FoldedRow, of_numbers};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span, Text};
use ratatui::widgets::{Block, Cell, Row, Table, TableState};

use super::metrics::{ActivityFigures, ActivityRemark, AgentFigures, Metrics};
use super::sample;
use super::sample::{ACTIVITY_HEADER, AGENT_HEADER};

const DIMMED: Style = Style::new().fg(Color::DarkGray);
const HEADER: Style = Style::new().add_modifier(Modifier::BOLD);
const GOOD: Style = Style::new().fg(Color::Green);
const WARNING: Style = Style::new().fg(Color::Yellow);
const ERROR: Style = Style::new().fg(Color::Red).add_modifier(Modifier::BOLD);

/// The metrics shown, and the selected agent.
pub(crate) struct Screen {
    figures: Metrics,
    /// Host and name, so that the selection survives a new order.
    selected: Option<(String, String)>,
}

impl Screen {
    pub(crate) fn new(figures: Metrics) -> Screen {
        Screen { figures, selected: None }
    }

    /// Replaces the metrics.
    pub(crate) fn show(&mut self, figures: Metrics) {
        self.figures = figures;
    }

    pub(crate) fn select_next(&mut self) {
        self.select(self.selected_index() + 1);
    }

    pub(crate) fn select_previous(&mut self) {
        self.select(self.selected_index().saturating_sub(1));
    }

    fn select(&mut self, index: usize) {
        let agents = &self.figures.agents;
        let agent = agents.get(index.min(agents.len().saturating_sub(1)));
        self.selected = agent.map(|agent| (agent.entry.host.clone(), agent.entry.name.clone()));
    }

    /// The index of the selected agent; 0 if none is selected or it is gone.
    fn selected_index(&self) -> usize {
        let is_it = |agent: &AgentFigures| {
            self.selected
                .as_ref()
                .is_some_and(|(host, name)| (host, name) == (&agent.entry.host, &agent.entry.name))
        };
        self.figures.agents.iter().position(is_it).unwrap_or(0)
    }

    pub(crate) fn draw(&self, frame: &mut Frame<'_>) {
        let agents = u16::try_from(self.figures.agents.len()).unwrap_or(u16::MAX).saturating_add(1);
        let rows = Layout::vertical([
            Constraint::Length(1),
            Constraint::Length(agents.min(frame.area().height / 2)),
            Constraint::Fill(2),
            Constraint::Fill(1),
            Constraint::Length(1),
        ]);
        let [head, agents, activities, topics, keys] = rows.areas(frame.area());
        frame.render_widget(self.head(), head);
        self.draw_agents(frame, agents);
        self.draw_activities(frame, activities);
        self.draw_topics(frame, topics);
        let last = match self.figures.alarms.first() {
            Some(alarm) => Line::styled(format!("alarm: {alarm}"), ERROR),
            None => Line::styled("up, down: choose an agent   q: quit", DIMMED),
        };
        frame.render_widget(last, keys);
    }

    fn head(&self) -> Line<'_> {
        let Metrics { run, now, agents, .. } = &self.figures;
        let load = agents.iter().filter_map(|agent| agent.load).reduce(|sum, load| sum + load);
        let figures = format!(
            "  {:.1} s  {} agents  {} of a core",
            now.as_secs_f64(),
            agents.len(),
            sample::share(load)
        );
        Line::from(vec![Span::styled(run.as_str(), HEADER), Span::raw(figures)])
    }

    fn draw_agents(&self, frame: &mut Frame<'_>, area: Rect) {
        let rows = self.figures.agents.iter().map(|agent| (sample::agent(agent), style_of(agent)));
        let table = table(AGENT_HEADER, 3, rows, area.width)
            .row_highlight_style(Style::new().add_modifier(Modifier::REVERSED));
        let mut state = TableState::default().with_selected(Some(self.selected_index()));
        frame.render_stateful_widget(table, area, &mut state);
    }

    fn draw_activities(&self, frame: &mut Frame<'_>, area: Rect) {
        let Some(agent) = self.figures.agents.get(self.selected_index()) else { return };
        let rows = agent.activities.iter().map(|one| (sample::activity(one), style_of_activity(one)));
        let reason = match agent.entry.reason.as_str() {
            "" => String::new(),
            reason => format!(": {reason}"),
        };
        let block =
            Block::bordered().title(format!(" {} on {}{reason} ", agent.entry.name, agent.entry.host));
        let table = table(ACTIVITY_HEADER, 3, rows, block.inner(area).width);
        frame.render_widget(table.block(block), area);
    }

    fn draw_topics(&self, frame: &mut Frame<'_>, area: Rect) {
        let rows = self.figures.topics.iter().map(|topic| {
            let cells =
                [topic.path.clone(), topic.host.clone(), topic.publisher.clone(), sample::number(topic.hz)];
            (cells, Style::new())
        });
        let block = Block::bordered().title(" topics ");
        let table = table(["topic", "host", "by", "Hz"], 3, rows, block.inner(area).width);
        frame.render_widget(table.block(block), area);
    }
}

/// Blanks between two columns.
const COLUMN_SPACING: u16 = 1;

/// A table of this width, with numbers from a column on. Columns are as wide as their contents.
fn table<'a, const N: usize>(
    header: [&str; N],
    first_number: usize,
    rows: impl Iterator<Item = ([String; N], Style)>,
    width: u16,
) -> Table<'a> {
    let (cells, styles): (Vec<[String; N]>, Vec<Style>) = rows.unzip();
    let folded = of_numbers(header, first_number, cells).folded(width.into(), COLUMN_SPACING.into());
    let rows = folded.rows.into_iter().zip(styles).map(|(cells, style)| row(cells, first_number, style));
    let widths =
        folded.widths.iter().map(|&width| Constraint::Length(u16::try_from(width).unwrap_or(u16::MAX)));
    Table::new(rows.collect::<Vec<_>>(), widths.collect::<Vec<_>>())
        .header(row(folded.header, first_number, HEADER))
        .column_spacing(COLUMN_SPACING)
}

/// A row with numbers from a column on.
fn row<'a>(cells: FoldedRow, first_number: usize, style: Style) -> Row<'a> {
    let height = cells.iter().map(Vec::len).max().unwrap_or_default();
    let cells = cells.into_iter().enumerate().map(|(column, lines)| {
        let text: Text<'a> = lines.into_iter().map(Line::from).collect();
        Cell::from(if column < first_number { text } else { text.right_aligned() })
    });
    Row::new(cells).height(u16::try_from(height).unwrap_or(u16::MAX)).style(style)
}

fn style_of(agent: &AgentFigures) -> Style {
    let is_remarked = agent.activities.iter().any(|one| one.remark.is_some());
    match agent.entry.state.as_str() {
        "stuck" | "stopped" => ERROR,
        _ if agent.overruns > 0 || is_remarked => WARNING,
        "runs" => GOOD,
        _ => DIMMED,
    }
}

fn style_of_activity(activity: &ActivityFigures) -> Style {
    match activity.remark {
        Some(ActivityRemark::Stuck | ActivityRemark::Fails) => ERROR,
        Some(
            ActivityRemark::Burns | ActivityRemark::Blocks | ActivityRemark::Leaks | ActivityRemark::Loops,
        ) => WARNING,
        None => Style::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use monas::records::{ActivityEntry, AgentEntry};
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;

    fn figures(names: &[&str]) -> Metrics {
        let agents = names.iter().map(|name| {
            let activity = ActivityEntry { name: format!("{name}s"), ..ActivityEntry::default() };
            let remark = (*name == "Vision").then_some(ActivityRemark::Burns);
            let entry = AgentEntry {
                host: "blue-2".into(),
                name: (*name).into(),
                state: "runs".into(),
                ..AgentEntry::default()
            };
            let activities =
                vec![ActivityFigures { entry: activity, hz: 30.0, load: Some(0.91), open_load: 0.0, remark }];
            AgentFigures { entry, hz: 30.0, load: Some(0.5), overruns: 0, activities }
        });
        Metrics {
            alarms: Vec::new(),
            run: "match".into(),
            now: Duration::from_secs(12),
            agents: agents.collect(),
            topics: Vec::new(),
        }
    }

    fn shown(screen: &Screen) -> Vec<String> {
        let mut terminal = Terminal::new(TestBackend::new(150, 16)).expect("a terminal");
        terminal.draw(|frame| screen.draw(frame)).expect("it is drawn");
        let buffer = terminal.backend().buffer();
        let lines = buffer.content().chunks(usize::from(buffer.area.width));
        lines
            .map(|line| line.iter().map(|cell| cell.symbol()).collect::<String>().trim_end().to_owned())
            .collect()
    }

    #[test]
    fn agents_are_listed_with_the_activities_of_the_selected_one() {
        let mut screen = Screen::new(figures(&["Vision", "Motion"]));
        let lines = shown(&screen);
        assert_eq!(lines[0], "match  12.0 s  2 agents  100.0 % of a core");
        assert!(lines[2].starts_with("blue-2 Vision runs"), "{lines:#?}");
        assert!(lines[4].contains(" Vision on blue-2 "), "{lines:#?}");
        for word in ["Visions", "burns a core", "91.0 %"] {
            assert!(lines[6].contains(word), "{lines:#?}");
        }
        screen.select_next();
        assert!(shown(&screen)[4].contains(" Motion on blue-2 "));
        screen.show(figures(&["Motion", "Vision"]));
        assert!(shown(&screen)[4].contains(" Motion on blue-2 "), "the one that was chosen");
        screen.select_next();
        screen.select_next();
        assert!(shown(&screen)[4].contains(" Vision on blue-2 "), "there is none behind the last");
        screen.show(figures(&["Motion"]));
        assert!(shown(&screen)[3].contains(" Motion on blue-2 "));
        screen.select_previous();
        screen.show(figures(&[]));
        assert!(shown(&screen)[0].contains("0 agents"));
    }
}
