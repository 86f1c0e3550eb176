use super::world::{compile_with, said};
use crate::expression::EventTable;
#[test]
fn scratch() {
    for text in [
        "[limt > 1]", "[nothing > 1]", "[PLAYING]", "[Ball]", "[near]", "[3m > 1]", "[GameState.player_state == PLAYNG]", "[GameState.player_state == GONE]", "[moton_timeout]", "[near(nothing, 1)]",
        "[both == 1]", "[GameState.player_state == READY]",
        "[Bal.distance > 1]", "[nowhere.State.Ball.distance > 1]", "[bal.State.Ball.distance > 1]", "[Zebra.distance > 1]",
        "[Arm.angle > 1]", "[arm.angle > 1]", "[Unheard.x > 1]", "[whistle.loudness > 1]", "[Point.x > 1]",
        "[Ball.distnce > 1]", "[Ball.distance.x > 1]", "[Ball.position.z > 1]",
        "[ball.Signal.Ball.distance > 1]", "[behavior.State.Fall.fall > 1]",
        "[abs(1, 2) > 1]", "[kick_off(1)]", "[abs() > 1]", "[crowded(1,2,3,4,5,6,7,8,9)]",
        "[Ball.distance]", "[Ball.found == 1]", "[GameState.player_state == 3]", "[Ball.distance == \"3\"]", "[Ball.position == Ball.position]", "[Ball.colour < \"a\"]", "[Ball.found > true]", "[GameState.player_state == GameState.phase]", "[Ball.distance + true > 1]", "[-Ball.found]", "[!Ball.distance]", "[GameState.player_state < PLAYING]", "[abs(Ball.found) > 1]", "[near(Arm, 1)]", "[near(GameState, 1)]", "[near(ball.State.Ball.position, 1)]", "[ball.State.Ball]", "[\"a\" && 1]",
        "[Ball.distance == NULL]", "[Bal == NULL]",
        "[In(nowhere)]", "[abz(1) > 1]",
        "/ StartTimeout(unknown, 1ms)", "/ StartTimeout(motion_timeout, 0.9ms)", "/ Vision.Ball.distance = 1", "/ striker.ball.State.Ball.distance = 1", "/ Ball = 1", "/ x = 1", "/ Ball.distance = true", "/ GameState.player_state = GONE", "/ publish.Vision.Ball", "/ publish.Ball.found", "/ publish.Bal", "/ raise(Ball)", "/ raise(motion)", "ball.State.Ball.found", "striker.ball.State.Ball", "Message.Arm", "whistle", "Message.Nothing", "e | nowhere.State.Ball",
        "Message.Nothing [abz(1) > 1 && Ball.distance || zzz] / raise(Ball); Ball.found = 1", "[abs(a) > zz + yy]",
    ] {
        let diagnostics = compile_with(text, &mut EventTable::new()).err().unwrap_or_default();
        println!("        ({text:?}, &[");
        for line in said(text, &diagnostics) { println!("            {line:?},"); }
        println!("        ]),");
    }
}
