//! Contestants that take turns, and the table of their figures.

/// The selected tables, and the number of rounds.
pub(crate) struct Selection {
    word: Option<String>,
    rounds: usize,
}

impl Selection {
    pub(crate) fn from_arguments() -> Selection {
        let mut selection = Selection { word: None, rounds: 9 };
        // Cargo passes `--bench`.
        for argument in std::env::args().skip(1).filter(|argument| !argument.starts_with("--")) {
            match argument.parse() {
                Ok(rounds) => selection.rounds = rounds,
                Err(_) => selection.word = Some(argument),
            }
        }
        selection
    }
}

/// One contestant: its name, and a function that runs a round and returns a figure per column.
pub(crate) type Contestant<'a> = (&'a str, Box<dyn FnMut() -> Vec<f64> + 'a>);

/// Runs the contestants in turns, after a warm-up round, and prints the medians of their figures.
pub(crate) fn run(
    selection: &Selection,
    title: &str,
    columns: &[&str],
    mut contestants: Vec<Contestant<'_>>,
) {
    if selection.word.as_ref().is_some_and(|word| !title.contains(word)) {
        return;
    }
    let mut figures = vec![Vec::new(); contestants.len()];
    for round in 0..=selection.rounds {
        for (index, (_, contestant)) in contestants.iter_mut().enumerate() {
            let figure = contestant();
            if round > 0 {
                figures[index].push(figure);
            }
        }
    }
    println!("\n{title} ({} rounds; median, smallest to largest)\n", selection.rounds);
    println!("| | {} |", columns.join(" | "));
    println!("|---|{}", "---:|".repeat(columns.len()));
    for ((name, _), rounds) in contestants.iter().zip(&figures) {
        let cells: Vec<_> = (0..columns.len()).map(|column| cell(rounds, column)).collect();
        println!("| {name} | {} |", cells.join(" | "));
    }
}

fn cell(rounds: &[Vec<f64>], column: usize) -> String {
    let mut sorted: Vec<f64> = rounds.iter().map(|round| round[column]).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else { return "-".to_owned() };
    format!("{} ({} to {})", Figure(sorted[sorted.len() / 2]), Figure(*first), Figure(*last))
}

/// A number with its significant digits.
struct Figure(f64);

impl std::fmt::Display for Figure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let decimals = if self.0 < 10.0 {
            2
        } else if self.0 < 100.0 {
            1
        } else {
            0
        };
        write!(f, "{:.*}", decimals, self.0)
    }
}

/// Nanoseconds that `work` takes: the median of many batches, each so short that few of them are
/// interrupted.
pub(crate) fn nanos_each(mut work: impl FnMut()) -> f64 {
    const BATCHES: usize = 101;
    const BATCH: u32 = 300;
    let mut batches = [0.0; BATCHES];
    for batch in &mut batches {
        let start = std::time::Instant::now();
        (0..BATCH).for_each(|_| work());
        *batch = start.elapsed().as_nanos() as f64 / f64::from(BATCH);
    }
    batches.sort_by(f64::total_cmp);
    batches[BATCHES / 2]
}

/// The median and the 99th percentile of latencies in nanoseconds, in microseconds.
pub(crate) fn percentiles(mut latencies: Vec<u64>) -> Vec<f64> {
    latencies.sort_unstable();
    let at = |share: usize| latencies.get(latencies.len() * share / 100).copied().unwrap_or(0);
    vec![at(50) as f64 / 1000.0, at(99) as f64 / 1000.0]
}
