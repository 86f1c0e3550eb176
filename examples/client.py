#!/usr/bin/env python3
"""Reads a robot's ball position and commands the robot, as a plain zenoh client.

    pip install eclipse-zenoh protobuf
    cargo run -p monas-link --features zenoh --example player -- robot listen tcp/127.0.0.1:7447
    python3 examples/client.py tcp/127.0.0.1:7447
"""

import json
import sys
import threading

import zenoh
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

NAME = "laptop"


def messages():
    """The messages of proto/example.proto, built without protoc."""
    field = descriptor_pb2.FieldDescriptorProto
    file = descriptor_pb2.FileDescriptorProto(
        name="example.proto", package="monas.link.example", syntax="proto3"
    )
    ball = file.message_type.add(name="Ball")
    ball.field.add(name="distance", number=1, type=field.TYPE_DOUBLE, label=field.LABEL_OPTIONAL)
    ball.field.add(name="bearing", number=2, type=field.TYPE_DOUBLE, label=field.LABEL_OPTIONAL)
    command = file.message_type.add(name="Command")
    command.field.add(name="text", number=1, type=field.TYPE_STRING, label=field.LABEL_OPTIONAL)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    find = pool.FindMessageTypeByName
    return [
        message_factory.GetMessageClass(find(f"monas.link.example.{name}")) for name in ("Ball", "Command")
    ]


def main():
    endpoint, balls = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 3
    Ball, Command = messages()
    config = zenoh.Config()
    config.insert_json5("mode", json.dumps("client"))
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    heard = threading.Semaphore(0)

    def hear(sample):
        host = str(sample.key_expr).split("/")[1]
        ball = Ball.FromString(bytes(sample.payload))
        print(f"ball of {host}: {ball.distance:.1f} m", flush=True)
        heard.release()

    with zenoh.open(config) as session:
        subscriber = session.declare_subscriber("monas/*/m/soccer/ball", hear)
        for number in range(balls):
            if not heard.acquire(timeout=20):
                sys.exit("no ball in 20 seconds")
            command = Command(text=f"kick {number} of {NAME}")
            session.put(f"monas/{NAME}/m/soccer/command", command.SerializeToString())
        subscriber.undeclare()


main()
