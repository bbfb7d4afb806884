# SPDX-License-Identifier: Apache-2.0
"""Reads a recording with the public reader, checksums and all: decode.py FILE prints, as JSON, its
tables, attached files, what is said of channels, counts by topic, and the messages of the topics
that are named after FILE."""
import hashlib
import json
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory


def plain(value):
    """What a decoded message says, as dictionaries and lists."""
    if hasattr(value, "__slots__"):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, (str, int, float, bool)) or value is None:
        return value
    return [plain(v) for v in value]


def main():
    path, shown = sys.argv[1], sys.argv[2:]
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        statistics = reader.get_summary().statistics
        out = {"count": statistics.message_count, "topics": {}, "messages": [], "raw": {},
               "tables": {m.name: m.metadata for m in reader.iter_metadata()},
               "files": {a.name: a.data.decode("latin1") for a in reader.iter_attachments()}}
        sums = {}
        for schema, channel, message in reader.iter_messages():
            out["raw"][channel.topic] = out["raw"].get(channel.topic, 0) + 1
            line = b"%d %s " % (message.log_time, channel.topic.encode())
            sums.setdefault(channel.topic, hashlib.sha256()).update(line + message.data)
        out["pairs"] = {c.topic: c.metadata for c in reader.get_summary().channels.values()}
        out["sums"] = {topic: s.hexdigest() for topic, s in sums.items()}
        topics = [c.topic for c in reader.get_summary().channels.values() if c.schema_id]
        for schema, channel, message, decoded in reader.iter_decoded_messages(topics=topics):
            out["topics"][channel.topic] = out["topics"].get(channel.topic, 0) + 1
            said = plain(decoded)
            if channel.topic in shown:
                out["messages"].append([channel.topic, message.log_time, message.publish_time, said])
    print(json.dumps(out))


if __name__ == "__main__":
    main()
