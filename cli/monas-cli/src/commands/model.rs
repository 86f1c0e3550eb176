//! `monas model`: reads, transforms, converts, compares, draws and checks models.

mod check;
mod compose;
mod conform;
mod convert;
mod coverage;
mod diff;
mod draw;
mod exploration;
mod finding;
mod model_format;
mod mutate;
mod ontology;
pub(crate) mod program;
mod regenerate;
mod robot_file;
mod run;
mod scenario;
mod transform;

use clap::Subcommand;
use monas_terminal::{CommandFailure, CommandOutput, Exit};

use self::check::CheckArguments;
use self::compose::ComposeArguments;
use self::conform::ConformArguments;
use self::convert::ConvertArguments;
use self::coverage::CoverageArguments;
use self::diff::DiffArguments;
use self::draw::DrawArguments;
use self::mutate::MutateArguments;
use self::ontology::OntologyArguments;
use self::regenerate::RegenerateArguments;
use self::run::PlayArguments;
use self::transform::TransformArguments;

#[derive(Subcommand, Debug)]
pub(crate) enum ModelCommand {
    /// Transform a model into another model of the method; without --to, into the statechart it
    /// describes.
    ///
    /// The statechart is an outline to be read; with --as, or with an output file that has an
    /// extension of models, it is a file of that format.
    #[command(after_help = "Example: monas model transform models/goalie.srm")]
    Transform(TransformArguments),
    /// Convert a model to another format of its kind.
    ///
    /// Losses are listed, and nothing is written unless --lossy is given.
    #[command(after_help = "Example: monas model convert models/goalie.srm goalie.scxml --lossy")]
    Convert(ConvertArguments),
    /// Draw the statechart of a model as SVG.
    #[command(after_help = "Example: monas model draw models/goalie.srm --compact -o goalie.svg")]
    Draw(DrawArguments),
    /// Derive the messages of a chart as a `.proto` file: the names of its variables, and the
    /// fields that its expressions use.
    ///
    /// The type of a field follows from its use; complete the file by hand.
    #[command(
        after_help = "Example: monas model ontology models/extended_attacker.iac --package team -o messages/team.proto"
    )]
    Ontology(OntologyArguments),
    /// Check models for errors.
    ///
    /// Names are checked against the messages, functions and activities of this program; for a
    /// model of another program this is left out with --unlinked.
    ///
    /// Exits with 0 if there are no errors, with 3 if a model cannot be read, and with 5 if a check
    /// finds an error.
    #[command(after_help = "Example: monas model check models/goalie.srm")]
    Check(CheckArguments),
    /// Check whether charts conform to a protocol: the protocol's own chart and those of its
    /// players.
    ///
    /// The kind of each file is detected: protocols (AIP), their charts (EAC; derived from the
    /// protocols if not given), charts or roles of players. Exits with 0 if all conform, and with 5
    /// otherwise.
    #[command(
        after_help = "Example: monas model conform models/extended_attacker.iac models/attack.eac models/attack.aip"
    )]
    Conform(ConformArguments),
    /// Check whether robots with one role each can deadlock.
    ///
    /// A message passes from one robot to another if the first robot's chart publishes or writes it
    /// and the second robot's chart reads it by the name of the first, as in
    /// `receiver.ready.Signal.Ready`. Messages are delayed. If a protocol (AIP, EAC) is given, its
    /// participants are checked against it, and each part must be taken. Exits with 0 if there are
    /// no errors, with 3 if a model cannot be read, and with 5 if there is a deadlock or the
    /// exploration is not finished.
    #[command(
        after_help = "Example: monas model compose passer.srm receiver.srm --traces . ; monas model run passer.srm receiver.srm composed-E0930-1.trace"
    )]
    Compose(ComposeArguments),
    /// Measure which states, transitions and guards of their charts recorded runs covered.
    ///
    /// A guard counts as true if its transition fired, and as false if a transition of the same
    /// state fired that is tried after it.
    #[command(
        after_help = "Example: monas run config/match.xml --record match.mcap ; monas model coverage match.mcap --draw coverage"
    )]
    Coverage(CoverageArguments),
    /// Compare the statecharts of two models: states, transitions and their expressions.
    ///
    /// Exits with 0 if they are equal, and with 5 if they differ.
    #[command(after_help = "Example: monas model diff before.srm after.srm -o difference.svg")]
    Diff(DiffArguments),
    /// Keep the refinements of a role's states and transitions after its formulas were edited.
    ///
    /// Refinements that still match are kept. The others are listed, and stay in the text as
    /// comments.
    #[command(after_help = "Example: monas model regenerate role.srm -o role.srm
Apply the refinements of another role or chart by --from: monas model regenerate role.srm --from edited.stct")]
    Regenerate(RegenerateArguments),
    /// Test scenarios by mutation: change a chart in one place at a time, and report which changes
    /// no scenario detects.
    ///
    /// Guards, numbers, timers, actions, targets and priorities are changed. A mutant that cannot
    /// run is refused and not counted. For each survivor the report says what a scenario would have
    /// to distinguish. Exits with 3 if a scenario fails on the model itself, and with 5 if less
    /// than --least is detected.
    #[command(
        after_help = "Example: monas model mutate models/goalie.srm --scenarios tests/scenarios --least 80"
    )]
    Mutate(MutateArguments),
    /// Play a scenario, or a trace from `model check` or `model compose`, and print each step.
    ///
    /// A scenario gives messages and times, and its expectations are checked. A trace gives the
    /// values of conditions on messages and the expiry of timers. A trace of several robots is
    /// played on the charts of all of them. Exits with 5 if an expectation fails or the chart stops
    /// with an error.
    #[command(
        after_help = "Example: monas model run models/goalie.srm tests/scenarios/goalie/dive_right.scenario
A trace: monas model check role.srm --traces . ; monas model run role.srm role-M14-1.trace"
    )]
    Run(PlayArguments),
}

pub(crate) fn execute(
    command: &ModelCommand,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match command {
        ModelCommand::Transform(arguments) => transform::execute(arguments, console),
        ModelCommand::Convert(arguments) => convert::execute(arguments, console),
        ModelCommand::Draw(arguments) => draw::execute(arguments, console),
        ModelCommand::Ontology(arguments) => ontology::execute(arguments, console),
        ModelCommand::Check(arguments) => check::execute(arguments, console),
        ModelCommand::Conform(arguments) => conform::execute(arguments, console),
        ModelCommand::Compose(arguments) => compose::execute(arguments, console),
        ModelCommand::Coverage(arguments) => coverage::execute(arguments, console),
        ModelCommand::Diff(arguments) => diff::execute(arguments, console),
        ModelCommand::Regenerate(arguments) => regenerate::execute(arguments, console),
        ModelCommand::Mutate(arguments) => mutate::execute(arguments, console),
        ModelCommand::Run(arguments) => run::execute(arguments, console),
    }
}
