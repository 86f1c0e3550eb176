//! Options of `monas run` for the league's GameController.

use std::io;
use std::time::Duration;

use clap::{Args, ValueEnum};
use monas::duration;
use monas_gamecontroller::{ControlReceiver, ControlSender, Endpoint, RETURN_PORT, RuleBook};
use monas_match::MatchPlan;

/// The match's end of the league's protocol.
#[derive(Args, Debug)]
pub(crate) struct LeagueArguments {
    /// Let a GameController decide instead of the match's own referee. The robots listen for it at
    /// this address of this computer, and report to it: 127.0.0.1, or 0.0.0.0 for broadcasts. The
    /// port is 3838 if not given. Needs --realtime.
    #[arg(long, value_name = "ADDRESS", requires = "realtime")]
    #[arg(conflicts_with = "referee")]
    pub(crate) gamecontroller: Option<Endpoint>,
    /// Send the decisions of the match's referee to robots at this address, as a GameController
    /// does, and receive their reports. The port is 3838 if not given. Needs --realtime.
    #[arg(long, value_name = "ADDRESS", requires = "realtime")]
    pub(crate) referee: Option<Endpoint>,
    /// The rule book of the packets of --referee: Standard Platform League (version 18) or Humanoid
    /// Soccer League (version 19).
    #[arg(long, value_name = "LEAGUE", value_enum, default_value = "spl", requires = "referee")]
    pub(crate) rules: RuleBookArgument,
    /// The delay with which --referee announces the beginning of play and goals, since robots
    /// should hear the whistle; 15s in the league.
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, default_value = "0s")]
    #[arg(requires = "referee")]
    pub(crate) whistle_delay: Duration,
    /// The port for reports of robots.
    #[arg(long, value_name = "PORT", default_value_t = RETURN_PORT)]
    pub(crate) return_port: u16,
}

/// A rule book.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum RuleBookArgument {
    /// Standard Platform League.
    Spl,
    /// Humanoid Soccer League.
    Hsl,
}

impl RuleBookArgument {
    pub(crate) fn rule_book(self) -> RuleBook {
        match self {
            RuleBookArgument::Spl => RuleBook::StandardPlatform,
            RuleBookArgument::Hsl => RuleBook::HumanoidSoccer,
        }
    }
}

impl LeagueArguments {
    /// Whether the match takes part in the protocol.
    pub(crate) fn is_given(&self) -> bool {
        self.gamecontroller.is_some() || self.referee.is_some()
    }

    /// Connects a match to the network.
    pub(crate) fn join(&self, plan: MatchPlan) -> Result<MatchPlan, String> {
        let port = self.return_port;
        if let Some(listen) = self.gamecontroller {
            let refused = |error: io::Error| format!("cannot listen at {listen}: {error}");
            let receiver = ControlReceiver::open(listen).map_err(refused)?;
            return Ok(plan.follow_gamecontroller(receiver.with_return_port(port)));
        }
        let Some(to) = self.referee else { return Ok(plan) };
        let refused = |error: io::Error| format!("cannot receive reports at port {port}: {error}");
        let sender = ControlSender::open(to, port).map_err(refused)?;
        Ok(plan.referee_others(sender, self.rules.rule_book(), self.whistle_delay))
    }
}
