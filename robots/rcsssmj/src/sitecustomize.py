"""Names the shapes of robots that have no name: a K1 has such ones.

Version 0.2.1 of the server ends with an error when a shape without a name touches the ball. Python
imports this module when the server starts, before the server's own ones.
"""

import os

# Not in the programs that the server's modules start: they would import this module in turn.
os.environ["PYTHONPATH"] = os.pathsep.join(os.environ["PYTHONPATH"].split(os.pathsep)[1:])

from rcsssmj.resources.spec_provider import ModelSpecProvider

load_robot_spec = ModelSpecProvider.load_robot_spec


def load_named(self, robot, variant=None):
    """The model of a robot; shapes without a name have that of their body, and a number."""
    model = load_robot_spec(self, robot, variant)
    for body in model.bodies if model is not None else ():
        colliding = [geom for geom in body.geoms if geom.contype or geom.conaffinity]
        for number, geom in enumerate(colliding):
            if not geom.name:
                geom.name = f"{body.name}_{number}" if number else body.name
    return model


ModelSpecProvider.load_robot_spec = load_named
