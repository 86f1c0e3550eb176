//! The report on a replay as text and JSON.

use std::io::Write;

use monas::replay::{ComparisonCounts, ReplayDifference};
use monas_tape::{Channel, Decoder, FieldDifference, Recording, TapeOverview, Value};
use monas_terminal::{CommandFailure, Format, counted, grouped, table};
use serde_json::{Value as Json, json};

use super::ReplayOutcome;
use super::names::AgentNames;
use crate::commands::tape::value_text;

/// The largest number of fields of one message in the text.
const MOST_FIELDS: usize = 12;

pub(crate) fn write(
    out: &mut dyn Write,
    format: Format,
    recording: &Recording,
    overview: &TapeOverview,
    outcome: &ReplayOutcome,
) -> Result<(), CommandFailure> {
    let first =
        outcome.first.as_ref().map(|difference| FirstDifference::new(recording, overview, difference));
    match format {
        Format::Text => write_text(out, first.as_ref(), outcome),
        Format::Json => {
            let first = first.iter().map(FirstDifference::object);
            let mut objects =
                first.chain(outcome.tallies.iter().map(tally_object)).chain([summary_object(outcome)]);
            Ok(objects.try_for_each(|object| writeln!(out, "{object}"))?)
        }
    }
}

fn write_text(
    out: &mut dyn Write,
    first: Option<&FirstDifference<'_>>,
    outcome: &ReplayOutcome,
) -> Result<(), CommandFailure> {
    if let Some(first) = first {
        first.write(out)?;
        let header = ["agent", "topic", "compared", "differ", "only recorded", "only replayed"];
        let differing = outcome.tallies.iter().filter(|tally| tally.differences() > 0);
        writeln!(out, "\n{}\n", table::of_numbers(header, 2, differing.map(tally_row)))?;
    }
    let mut agents: Vec<(&str, &str)> =
        outcome.tallies.iter().map(|tally| (&*tally.host, &*tally.agent)).collect();
    agents.dedup();
    let (length, took) = (outcome.length.as_secs_f64(), outcome.took.as_secs_f64());
    writeln!(
        out,
        "{length:.1} s of {} replayed in {took:.1} s: {:.0} recorded seconds per wall second",
        counted(agents.len() as u64, "agent"),
        length / took.max(1e-9)
    )?;
    let (compared, differences) = (outcome.compared(), outcome.differences());
    writeln!(out, "{} compared, {}", counted(compared, "message"), counted(differences, "difference"))?;
    Ok(())
}

fn tally_row(tally: &ComparisonCounts) -> [String; 6] {
    let counts = [tally.compared, tally.different, tally.only_recorded, tally.only_replayed].map(grouped);
    let [compared, different, only_recorded, only_replayed] = counts;
    let agent = format!("{}/{}", tally.host, tally.agent);
    [agent, tally.topic.clone(), compared, different, only_recorded, only_replayed]
}

fn tally_object(tally: &ComparisonCounts) -> Json {
    json!({"kind": "tally", "host": tally.host, "agent": tally.agent, "topic": tally.topic, "compared": tally.compared,
        "different": tally.different, "only_recorded": tally.only_recorded, "only_replayed": tally.only_replayed})
}

fn summary_object(outcome: &ReplayOutcome) -> Json {
    let (length, took) = (outcome.length.as_secs_f64(), outcome.took.as_secs_f64());
    json!({"kind": "replay", "compared": outcome.compared(), "differences": outcome.differences(),
        "recorded_seconds": length, "wall_seconds": took,
        "recorded_seconds_per_wall_second": length / took.max(1e-9)})
}

/// The first difference, decoded.
struct FirstDifference<'a> {
    difference: &'a ReplayDifference,
    recorded: Option<Value>,
    replayed: Option<Value>,
    names: AgentNames,
}

impl<'a> FirstDifference<'a> {
    fn new(
        recording: &Recording,
        overview: &TapeOverview,
        difference: &'a ReplayDifference,
    ) -> FirstDifference<'a> {
        let channels = || overview.channels.iter().map(|counted| &*counted.channel);
        let own = channels().find(|channel| {
            let Channel { host, publisher, topic, .. } = channel;
            (host, publisher, topic) == (&difference.host, &difference.agent, &difference.topic)
        });
        // If the agent published nothing on the topic in the recording, another publisher may have.
        let channel = own.or_else(|| channels().find(|channel| channel.topic == difference.topic));
        let mut decoder = Decoder::new();
        let mut decode = |bytes: &Option<Vec<u8>>| decoder.decode(channel?, bytes.as_deref()?).ok();
        let (recorded, replayed) = (decode(&difference.recorded), decode(&difference.replayed));
        FirstDifference { difference, recorded, replayed, names: AgentNames::of(recording, difference) }
    }

    /// The kind of difference, in a few words.
    fn what(&self) -> &'static str {
        match (&self.difference.recorded, &self.difference.replayed) {
            (Some(recorded), Some(replayed)) if recorded == replayed => "published in another order",
            (Some(_), Some(_)) => "published otherwise",
            (Some(_), None) => "not published any more",
            _ => "not published then",
        }
    }

    /// The fields that differ; all fields if only one side published the message.
    fn fields(&self) -> Vec<FieldDifference<'_>> {
        match (&self.recorded, &self.replayed) {
            (Some(recorded), Some(replayed)) => recorded.differences(replayed),
            (Some(recorded), None) => listed(recorded, |path, value| one_sided(path, Some(value), None)),
            (None, Some(replayed)) => listed(replayed, |path, value| one_sided(path, None, Some(value))),
            (None, None) => Vec::new(),
        }
    }

    /// The number of the chart of a record.
    fn chart(&self) -> u64 {
        let Some(Value::Fields(fields)) = self.recorded.as_ref().or(self.replayed.as_ref()) else { return 0 };
        let chart = fields.iter().find(|(name, _)| name == "chart");
        if let Some((_, Value::Uint(number))) = chart { *number } else { 0 }
    }

    fn values(&self, field: &FieldDifference<'_>) -> [String; 2] {
        let text = |value: Option<&Value>| {
            value.map_or_else(|| "-".into(), |value| self.names.value_text(&field.path, self.chart(), value))
        };
        [text(field.first), text(field.second)]
    }

    fn write(&self, out: &mut dyn Write) -> Result<(), CommandFailure> {
        let ReplayDifference { host, agent, cycle, time, topic, .. } = self.difference;
        let seconds = time.as_secs_f64();
        writeln!(out, "first difference: {host}/{agent}, cycle {cycle}, topic {topic}, {seconds:.3} s")?;
        let fields = self.fields();
        writeln!(out, "{}{}", self.what(), if fields.is_empty() { "" } else { ":" })?;
        let rows = fields.iter().take(MOST_FIELDS).map(|field| {
            let [recorded, replayed] = self.values(field);
            [field.path.clone(), recorded, replayed]
        });
        let rows: Vec<[String; 3]> =
            std::iter::once(["field", "recorded", "replayed"].map(str::to_owned)).chain(rows).collect();
        let width =
            |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or_default();
        let (first, second) = (width(0), width(1));
        if !fields.is_empty() {
            rows.iter().try_for_each(|[field, then, now]| {
                writeln!(out, "  {field:first$}  {then:second$}  {now}")
            })?;
        }
        match fields.len().saturating_sub(MOST_FIELDS) {
            0 => Ok(()),
            more => Ok(writeln!(out, "  and {more} more")?),
        }
    }

    fn object(&self) -> Json {
        let ReplayDifference { host, agent, cycle, time, topic, .. } = self.difference;
        let fields: Vec<Json> = self.fields().iter().map(field_object).collect();
        json!({"kind": "difference", "host": host, "agent": agent, "cycle": cycle, "topic": topic,
            "seconds": time.as_secs_f64(), "what": self.what(), "fields": fields})
    }
}

fn field_object(field: &FieldDifference<'_>) -> Json {
    let value = |value: Option<&Value>| value.map_or(Json::Null, value_text::json);
    json!({"field": field.path, "recorded": value(field.first), "replayed": value(field.second)})
}

fn one_sided<'a>(path: &str, first: Option<&'a Value>, second: Option<&'a Value>) -> FieldDifference<'a> {
    FieldDifference { path: path.to_owned(), first, second }
}

/// The scalar values of a message.
fn listed<'a>(
    value: &'a Value,
    make: impl Fn(&str, &'a Value) -> FieldDifference<'a>,
) -> Vec<FieldDifference<'a>> {
    let mut found = Vec::new();
    value_text::cells(value, &mut |path, value| found.push(make(path, value)));
    found
}
