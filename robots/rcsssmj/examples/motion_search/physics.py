"""The world of the soccer server with one robot and the ball, without the server's sockets.

The arguments are the name of the robot, T1 or K1, and the height of its torso in a straight stand.

Reads commands from standard input and answers each with the state on standard output, both as
64 bit numbers, the lowest byte first. The first number of a command says what it is:

0  puts the robot upright at the origin, and the ball to a place: x and y, m.
1  makes one cycle of the server with commands to all motors: angles, stiffnesses, dampings.

The answer: angles and velocities of the joints, the rates of the gyroscope and accelerations of
the torso, cut off after the digits that the server sends; x, y and z of the torso, its heading and
the cosine of its inclination; x and y of the ball.
"""

import logging
import math
import os
import struct
import sys

import mujoco
import numpy as np
from rcsssmj.games.soccer.sim.soccer_referee import SoccerReferee
from rcsssmj.games.soccer.sim.soccer_sim import SoccerSimulation
from rcsssmj.games.soccer.soccer_fields import create_soccer_field
from rcsssmj.games.soccer.soccer_rules import create_soccer_rule_book

MODEL = sys.argv[1]
UPRIGHT = float(sys.argv[2])
MOTORS = ["he1", "he2"]
MOTORS += [f"{side}ae{joint}" for side in "lr" for joint in range(1, 5)]
MOTORS += ["te1"] if MODEL == "T1" else []
MOTORS += [f"{side}le{joint}" for side in "lr" for joint in range(1, 7)]
SUBSTEPS = 4
BALL = 0.11


class Robot:
    """What a new agent tells the server of itself."""

    model_name = MODEL
    team_name = "Monas"
    player_no = 2


def cut(values):
    """Degrees or metres as the server sends them."""
    return np.trunc(values * 100) / 100


def main():
    logging.disable(logging.CRITICAL)
    # MuJoCo writes its warnings to the standard output.
    outputs = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    rules = create_soccer_rule_book("ssim")
    field = create_soccer_field(rules.default_field_version.value)
    world = SoccerSimulation(field, rules=rules, referee=SoccerReferee())
    world.init()
    world.step([])
    prefix = world.add_players([Robot])[0].agent_id.prefix
    model, data = world.mj_model, world.mj_data
    angle, velocity, torque = (
        np.array([model.actuator(prefix + motor + kind).id for motor in MOTORS])
        for kind in ("_pos", "_vel", "_tau")
    )
    joints = model.actuator_trnid[angle, 0]
    at, rate = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
    free = [model.jnt_qposadr[i] for i in range(model.njnt) if model.jnt_type[i] == 0]
    ball = model.joint("ball-root").qposadr[0]
    root = next(i for i in free if i != ball)
    ball, ball_rate = model.joint("ball-root").qposadr[0], model.joint("ball-root").dofadr[0]

    def sensor(kind):
        first = model.sensor_adr[next(i for i in range(model.nsensor) if model.sensor_type[i] == kind)]
        return data.sensordata[first : first + 3]

    gyro, acceleration = (
        sensor(kind) for kind in (mujoco.mjtSensor.mjSENS_GYRO, mujoco.mjtSensor.mjSENS_ACCELEROMETER)
    )
    inputs = sys.stdin.buffer
    while len(head := inputs.read(8)) == 8:
        if struct.unpack("<d", head)[0] == 0:
            x, y = struct.unpack("<2d", inputs.read(16))
            mujoco.mj_resetData(model, data)
            data.qpos[root : root + 7] = (0, 0, UPRIGHT, 1, 0, 0, 0)
            data.qpos[ball : ball + 7] = (x, y, BALL, 1, 0, 0, 0)
            mujoco.mj_forward(model, data)
        else:
            target, stiffness, damping = np.frombuffer(inputs.read(24 * len(MOTORS)), "<f8").reshape(3, -1)
            data.ctrl[angle] = np.radians(np.round(np.degrees(target), 3))
            data.ctrl[velocity], data.ctrl[torque] = 0, 0
            model.actuator_gainprm[angle, 0], model.actuator_biasprm[angle, 1] = stiffness, -stiffness
            model.actuator_gainprm[velocity, 0], model.actuator_biasprm[velocity, 2] = damping, -damping
            mujoco.mj_step(model, data, SUBSTEPS)
        w, i, j, k = data.qpos[root + 3 : root + 7]
        heading = math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))
        state = np.concatenate((
            np.radians(cut(np.degrees(data.qpos[at]))),
            np.radians(cut(np.degrees(data.qvel[rate]))),
            np.radians(cut(np.degrees(gyro))),
            cut(acceleration),
            data.qpos[root : root + 3],
            (heading, 1 - 2 * (i * i + j * j)),
            data.qpos[ball : ball + 2],
        ))
        outputs.write(state.astype("<f8").tobytes())
        outputs.flush()


main()
