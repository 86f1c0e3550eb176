//! Six robots chase the ball using their simulated cameras; a picture of the final state goes to
//! standard output.
//!
//! `cargo run -p monas-sim --example kickabout -- 60 > field.svg` (the number is the length in
//! seconds)

use monas_sim::{
    Command, Error, Motion, Percept, STEP, Senses, Setup, Side, Sighting, SimulatedWorld, Velocity,
    render_svg,
};

/// Memory of a robot: where it last saw the ball, and how long ago.
#[derive(Default, Clone)]
struct Memory {
    ball: Option<Percept>,
    unseen: f64,
}

impl Memory {
    fn update(&mut self, senses: &Senses) {
        let seen = senses.sightings.iter().find_map(|sighting| match sighting {
            Sighting::Ball(percept) => Some(*percept),
            _ => None,
        });
        self.unseen = if seen.is_some() { 0.0 } else { self.unseen + STEP };
        self.ball = if self.unseen < 0.5 { seen.or(self.ball) } else { None };
    }

    fn decide(&self, senses: &Senses) -> Command {
        if senses.is_fallen() {
            return Command::new(Motion::StandUp);
        }
        let Some(ball) = self.ball else { return search(senses.time) };
        let motion = if ball.distance > 0.22 {
            Motion::Walk(Velocity::new(0.25, 0.0, 1.5 * ball.bearing))
        } else {
            Motion::Kick(Side::of(ball.bearing))
        };
        Command {
            head_yaw: ball.bearing,
            head_pitch: 0.3 / ball.distance.max(0.3) - 0.4,
            motion,
            ..Command::default()
        }
    }
}

/// Turns and nods until the ball comes into view.
fn search(time: f64) -> Command {
    let nod = if time.fract() < 0.5 { 0.0 } else { 0.4 };
    Command {
        head_yaw: 0.0,
        head_pitch: nod,
        motion: Motion::Walk(Velocity::new(0.0, 0.0, 0.8)),
        ..Command::default()
    }
}

fn main() -> Result<(), Error> {
    let seconds = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(60.0);
    let mut world = SimulatedWorld::new(Setup::three_against_three(7))?;
    let mut memories = vec![Memory::default(); world.robots().len()];
    let mut senses = Senses::default();
    while world.time() < seconds {
        for (robot, memory) in memories.iter_mut().enumerate() {
            world.sense(robot, &mut senses)?;
            memory.update(&senses);
            world.command(robot, memory.decide(&senses))?;
        }
        world.step();
    }
    for event in world.events() {
        eprintln!("{:6.2} {:?}", event.time, event.kind);
    }
    print!("{}", render_svg(&world));
    Ok(())
}
