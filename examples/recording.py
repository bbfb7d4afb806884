#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Where each robot was in a run, as a table: recording.py out/follow-1/run.mcap
Needs: pip install mcap mcap-ros2-support pandas"""
import sys

import pandas
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

rows = []
with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    for schema, channel, message, frame in reader.iter_decoded_messages(topics=["Frame"]):
        for robot in frame.robots:
            rows.append((frame.time_ns / 1e9, robot.name, robot.x_m, robot.y_m, robot.stalled))
table = pandas.DataFrame(rows, columns=["time_s", "robot", "x_m", "y_m", "stalled"])
print(table.groupby("robot")[["x_m", "y_m"]].describe().to_string())
