"""Where MuJoCo has feet, camera, hand and centre of mass of a robot of rcsssmj: T1 or K1.

Reads lines of the angles of its joints in radians, and writes 15 numbers for each: the points in the torso frame.
"""

import pathlib
import sys

import mujoco
import rcsssmj

SOLES = {"T1": 0.03, "K1": 0.038}
file = pathlib.Path(rcsssmj.__file__).parent / f"resources/robots/{sys.argv[1]}/robot.xml"
model = mujoco.MjModel.from_xml_path(str(file))
data = mujoco.MjData(model)
motors = ["he1", "he2"] + [f"{side}ae{joint}" for side in "lr" for joint in range(1, 5)]
motors += ["te1"] if sys.argv[1] == "T1" else []
motors += [f"{side}le{joint}" for side in "lr" for joint in range(1, 7)]
joints = [model.actuator_trnid[model.actuator(motor + "_pos").id, 0] for motor in motors]
places = [model.jnt_qposadr[joint] for joint in joints]
for line in sys.stdin.readlines():
    data.qpos[:7] = (0, 0, 0, 1, 0, 0, 0)
    data.qpos[places] = [float(angle) for angle in line.split()]
    mujoco.mj_forward(model, data)
    points = []
    for foot in ("left_foot_link", "right_foot_link"):
        body = data.body(foot)
        points.append(body.xpos + body.xmat.reshape(3, 3) @ (0, 0, -SOLES[sys.argv[1]]))
    points += [data.site("camera").xpos, data.body("left_hand_link").xpos]
    points.append(data.subtree_com[model.body("torso").id])
    print(*(number for point in points for number in point))
