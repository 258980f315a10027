#!/usr/bin/env python3
"""make.py [FOLDER]: writes the .mcap files of this folder, or of another, byte by byte as https://mcap.dev/spec says, and
what is in them.

Beside each file lies a .json in the form of the conformance files of foxglove/mcap: the records in their order, those of
a chunk in its place, without Chunk and MessageIndex; all numbers are strings. Where a file is damaged, "damage" is what a
reader must say of it, and the records are those that it must give all the same. "meta" lists the features: ch chunks, mx
message indexes, st statistics, rsh and rch schemas and channels again in the summary, ax, mdx and chx indexes of
attachments, metadata and chunks, sum summary offsets, pad bytes behind the known fields.

It shares no code with what it tests: that is read by tests/orchestrator/formats/mcap_conformance_test.cc."""

import json
import pathlib
import struct
import sys
import zlib

FOLDER = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent
MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
ATTACHMENT, ATTACHMENT_INDEX, STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = range(9, 16)
NAMES = {HEADER: "Header", FOOTER: "Footer", SCHEMA: "Schema", CHANNEL: "Channel", MESSAGE: "Message",
         CHUNK_INDEX: "ChunkIndex", ATTACHMENT: "Attachment", ATTACHMENT_INDEX: "AttachmentIndex",
         STATISTICS: "Statistics", METADATA: "Metadata", METADATA_INDEX: "MetadataIndex",
         SUMMARY_OFFSET: "SummaryOffset", DATA_END: "DataEnd"}
FULL = {"ch", "mx", "st", "rsh", "rch", "ax", "mdx", "chx", "sum"}


def text(value):
    data = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<I", len(data)) + data


def table(entries, pack):
    """A map, or a list of pairs: its size in bytes, and its entries."""
    data = b"".join(pack(key, value) for key, value in entries.items())
    return struct.pack("<I", len(data)) + data


def text_map(entries):
    return table(entries, lambda key, value: text(key) + text(value))


def record(op, body):
    return struct.pack("<BQ", op, len(body)) + body


# --- zstd (RFC 8878), without a compressor: a frame of one segment, whose block is stored or repeats a byte -----------


def zstd_stored(data):
    assert len(data) < 65792
    size = struct.pack("<BH", 0x60, len(data) - 256) if len(data) >= 256 else struct.pack("<BB", 0x20, len(data))
    return b"\x28\xb5\x2f\xfd" + size + struct.pack("<I", 1 | 0 << 1 | len(data) << 3)[:3] + data


PACKED = {"": lambda data: data, "zstd": zstd_stored, "lz4": lambda data: data}


class File:
    """Takes what a file holds, and writes it with the features that are asked for."""

    def __init__(self, features=(), compression="", crcs=True, profile="", library="by hand", pad=b"\1\xff\xff"):
        self.features, self.compression, self.crcs = set(features), compression, crcs
        self.pad = pad if "pad" in self.features else b""
        self.bytes, self.records, self.groups = bytearray(MAGIC), [], {}
        self.inside = None  # records of the open chunk, with their messages: (channel, log time, offset in the chunk)
        self.messages, self.times, self.counts = [], [], {}
        self.schemas, self.channels, self.chunks, self.attachments, self.metadata = {}, {}, 0, 0, 0
        self.put(HEADER, text(profile) + text(library), library=library, profile=profile)

    def crc(self, data):
        return zlib.crc32(data) if self.crcs else 0

    def note(self, op, fields):
        as_text = {name: self.shown(value) for name, value in fields.items()}
        self.records.append({"type": NAMES[op], "fields": [[name, as_text[name]] for name in sorted(as_text)]})

    @staticmethod
    def shown(value):
        if isinstance(value, bytes):
            return [str(byte) for byte in value]
        if isinstance(value, dict):
            return {str(key): str(entry) for key, entry in value.items()}
        return str(value)

    def put(self, op, body, *, is_padded=True, **fields):
        """Writes a record to the file, or to the open chunk. Returns its length."""
        data = record(op, body + (self.pad if is_padded else b""))
        (self.bytes if self.inside is None else self.inside).extend(data)
        if op in NAMES and fields:
            self.note(op, fields)
        return len(data)

    def unknown(self, op, body=b"of a later version"):
        self.put(op, body)

    def schema(self, number, name, encoding="ros2msg", data=b"uint64 n\n"):
        body = struct.pack("<H", number) + text(name) + text(encoding) + text(data)
        self.schemas[number] = (body, {"id": number, "name": name, "encoding": encoding, "data": data})
        self.put(SCHEMA, body, **self.schemas[number][1])

    def channel(self, number, schema, topic, encoding="cdr", metadata=None):
        metadata = metadata or {}
        body = struct.pack("<HH", number, schema) + text(topic) + text(encoding) + text_map(metadata)
        self.channels[number] = (body, {"id": number, "schema_id": schema, "topic": topic, "message_encoding": encoding,
                                        "metadata": metadata})
        self.put(CHANNEL, body, **self.channels[number][1])

    def message(self, channel, sequence, log_time, data, publish_time=None):
        publish_time = log_time if publish_time is None else publish_time
        if self.inside is not None:
            self.messages.append((channel, log_time, len(self.inside)))
        self.times.append(log_time)
        self.counts[channel] = self.counts.get(channel, 0) + 1
        self.put(MESSAGE, struct.pack("<HIQQ", channel, sequence, log_time, publish_time) + data, is_padded=False,
                 channel_id=channel, sequence=sequence, log_time=log_time, publish_time=publish_time, data=data)

    def index(self, op, pack, **fields):
        """Keeps a record for the summary. `pack` makes its body of the fields."""
        self.groups.setdefault(op, []).append((pack, fields))

    def attachment(self, name, media_type, data, log_time=0, create_time=0):
        body = struct.pack("<QQ", log_time, create_time) + text(name) + text(media_type) + struct.pack("<Q", len(data)) + data
        offset = len(self.bytes)
        length = self.put(ATTACHMENT, body + struct.pack("<I", self.crc(body)), name=name, media_type=media_type, data=data,
                          log_time=log_time, create_time=create_time)
        self.attachments += 1
        if "ax" in self.features:
            self.index(ATTACHMENT_INDEX, lambda f: struct.pack("<QQQQQ", f["offset"], f["length"], f["log_time"],
                                                               f["create_time"], f["data_size"])
                       + text(f["name"]) + text(f["media_type"]),
                       offset=offset, length=length, log_time=log_time, create_time=create_time, data_size=len(data),
                       name=name, media_type=media_type)

    def metadata_record(self, name, entries):
        offset = len(self.bytes)
        length = self.put(METADATA, text(name) + text_map(entries), name=name, metadata=entries)
        self.metadata += 1
        if "mdx" in self.features:
            self.index(METADATA_INDEX, lambda f: struct.pack("<QQ", f["offset"], f["length"]) + text(f["name"]),
                       offset=offset, length=length, name=name)

    def begin_chunk(self):
        if "ch" in self.features:
            self.inside = bytearray()

    def end_chunk(self, *, wrong_crc=False):
        if self.inside is None:
            return
        data, messages = bytes(self.inside), self.messages
        self.inside, self.messages = None, []
        times = [time for _, time, _ in messages] or [0]
        packed = PACKED[self.compression](data)
        offset = len(self.bytes)
        length = self.put(CHUNK, struct.pack("<QQQI", min(times), max(times), len(data), self.crc(data) ^ wrong_crc)
                          + text(self.compression) + struct.pack("<Q", len(packed)) + packed, is_padded=False)
        offsets, index_start = {}, len(self.bytes)
        for channel in sorted({channel for channel, _, _ in messages}) if "mx" in self.features else []:
            offsets[channel] = len(self.bytes)
            entries = b"".join(struct.pack("<QQ", time, at) for of, time, at in messages if of == channel)
            self.put(MESSAGE_INDEX, struct.pack("<H", channel) + text(entries))
        self.chunks += 1
        if "chx" in self.features:
            self.index(CHUNK_INDEX, lambda f: struct.pack("<QQQQ", f["message_start_time"], f["message_end_time"],
                                                          f["chunk_start_offset"], f["chunk_length"])
                       + table(f["message_index_offsets"], lambda channel, at: struct.pack("<HQ", channel, at))
                       + struct.pack("<Q", f["message_index_length"]) + text(f["compression"])
                       + struct.pack("<QQ", f["compressed_size"], f["uncompressed_size"]),
                       message_start_time=min(times), message_end_time=max(times), chunk_start_offset=offset,
                       chunk_length=length, message_index_offsets=offsets,
                       message_index_length=len(self.bytes) - index_start, compression=self.compression,
                       compressed_size=len(packed), uncompressed_size=len(data))

    def statistics(self, **wrong):
        fields = {"message_count": len(self.times), "schema_count": len(self.schemas), "channel_count": len(self.channels),
                  "attachment_count": self.attachments, "metadata_count": self.metadata, "chunk_count": self.chunks,
                  "message_start_time": min(self.times, default=0), "message_end_time": max(self.times, default=0),
                  "channel_message_counts": self.counts, **wrong}
        self.put(STATISTICS, struct.pack("<QHIIIIQQ", *[value for value in fields.values() if not isinstance(value, dict)])
                 + table(fields["channel_message_counts"], lambda channel, count: struct.pack("<HQ", channel, count)), **fields)

    def end(self, *, unknown=None, wrong_data_crc=False, wrong_crc=False, wrong_start=0, **wrong_statistics):
        """DataEnd, summary, footer. `unknown`: an opcode of a record in the summary that no version of today knows."""
        crc = self.crc(self.bytes) ^ wrong_data_crc
        self.put(DATA_END, struct.pack("<I", crc), data_section_crc=crc)
        start, offsets = len(self.bytes), []

        def group(op, write):
            begin = len(self.bytes)
            write()
            if len(self.bytes) > begin:
                offsets.append({"group_opcode": op, "group_start": begin, "group_length": len(self.bytes) - begin})

        for op, feature, known in [(SCHEMA, "rsh", self.schemas), (CHANNEL, "rch", self.channels)]:
            if feature in self.features:
                group(op, lambda op=op, known=known: [self.put(op, known[k][0], **known[k][1]) for k in sorted(known)])
        if "st" in self.features:
            group(STATISTICS, lambda: self.statistics(**wrong_statistics))
        for op in (CHUNK_INDEX, ATTACHMENT_INDEX, METADATA_INDEX):
            group(op, lambda op=op: [self.put(op, pack(fields), **fields) for pack, fields in self.groups.get(op, [])])
        if unknown:
            self.unknown(unknown)
        offset_start = len(self.bytes) if "sum" in self.features and offsets else 0
        for each in offsets if "sum" in self.features else []:
            self.put(SUMMARY_OFFSET, struct.pack("<BQQ", *each.values()), **each)
        is_empty = len(self.bytes) == start
        summary_start = 0 if is_empty else start + wrong_start
        footer = struct.pack("<BQQQ", FOOTER, 20, summary_start, offset_start)
        crc = self.crc(bytes(self.bytes[start:]) + footer) ^ wrong_crc
        self.put(FOOTER, footer[9:] + struct.pack("<I", crc), is_padded=False, summary_start=summary_start,
                 summary_offset_start=offset_start, summary_crc=crc)
        self.bytes.extend(MAGIC)
        return self


# --- the files ----------------------------------------------------------------------------------------------------


def numbers(file, sequences=((1, 0), (2, 0), (1, 1))):
    """Two channels of one schema, with a message at each millisecond, in one chunk if the file has chunks."""
    file.begin_chunk()
    file.schema(1, "test_msgs/msg/Number")
    channels = {1: ("/one", {"a": "b"}), 2: ("/two", {})}
    for at_ms, (channel, sequence) in enumerate(sequences):
        if topic := channels.pop(channel, None):  # in front of its first message, as McapWriter has it
            file.channel(channel, 1, topic[0], metadata=topic[1])
        file.message(channel, sequence, at_ms * 1_000_000, bytes([channel, sequence]) * 4)
    file.end_chunk()
    return file


def of_all_kinds(file):
    """Chunks, and between them an attachment and metadata, as a recording has them."""
    numbers(file)
    file.attachment("config.toml", "application/toml", b"[run]\nseed = 1\n")
    file.begin_chunk()
    file.message(2, 1, 3_000_000, b"\2\1" * 4)
    file.message(1, 2, 4_000_000, b"\1\2" * 4)
    file.end_chunk()
    file.metadata_record("mascot", {"agents": "2", "seed": "1"})
    return file


def files():
    """The files by name; those of `damaged()` follow."""
    yield "nothing", File().end()
    yield "nothing_but_statistics", File({"st"}).end()
    yield "loose_messages", numbers(File()).end()
    yield "loose_messages_with_all_of_a_summary", numbers(File({"st", "rsh", "rch", "sum"})).end()
    yield "a_chunk_without_any_index", numbers(File({"ch"})).end()
    yield "a_chunk_with_statistics_alone", numbers(File({"ch", "st"})).end()
    yield "a_chunk_with_message_indexes_alone", numbers(File({"ch", "mx"})).end()
    yield "a_chunk_with_its_index_alone", numbers(File({"ch", "chx"})).end()
    yield "a_chunk_without_message_indexes", numbers(File(FULL - {"mx"})).end()
    yield "a_packed_chunk", numbers(File(FULL, compression="zstd")).end()
    yield "all_kinds", of_all_kinds(File(FULL, profile="ros2")).end()
    yield "all_kinds_packed", of_all_kinds(File(FULL, compression="zstd", profile="ros2")).end()
    yield "all_kinds_without_checksums", of_all_kinds(File(FULL, crcs=False)).end()
    yield "all_kinds_loose", of_all_kinds(File(FULL - {"ch", "mx", "chx"})).end()
    yield "all_kinds_with_longer_records", of_all_kinds(File(FULL | {"pad"})).end()

    late = File(FULL - {"sum"})  # channels of a chunk that are used in the next, and are told there again
    numbers(late)
    late.begin_chunk()
    late.channel(1, 1, "/one", metadata={"a": "b"})
    late.schema(2, "", encoding="", data=b"")
    late.channel(3, 2, "/three", encoding="", metadata={"": "", "k": "\u00fc\n"})
    for channel, sequence in [(3, 0), (1, 2), (2, 1)]:
        late.message(channel, sequence, 5, b"")
    late.end_chunk()
    yield "channels_that_are_told_again", late.end()

    some = File(FULL)
    some.begin_chunk()
    some.end_chunk()
    yield "an_empty_chunk", some.end()

    largest = File(FULL, profile="\u00b5", library="")
    largest.begin_chunk()
    largest.schema(65535, "s", encoding="jsonschema", data=b"{}")
    largest.channel(0, 0, "/no_schema", encoding="json")
    largest.channel(65535, 65535, "/largest")
    largest.message(65535, 2**32 - 1, 2**64 - 1, b"\xff", publish_time=0)
    largest.message(0, 7, 0, b"{}", publish_time=2**64 - 1)
    largest.message(65535, 0, 2**63, bytes(range(256)), publish_time=1)
    largest.end_chunk()
    yield "least_and_largest_numbers", largest.end()

    unknown = File(FULL)
    unknown.unknown(0x10)
    unknown.begin_chunk()
    unknown.unknown(0x80)
    unknown.schema(1, "s")
    unknown.channel(1, 1, "/one")
    unknown.unknown(0xff, b"")
    unknown.message(1, 0, 1, b"one")
    unknown.unknown(0x7f)
    unknown.end_chunk()
    unknown.unknown(0x80)
    yield "records_that_nobody_knows", unknown.end(unknown=0x42)

    things = File({"ax", "mdx", "st"})
    things.attachment("empty", "", b"")
    things.attachment("two", "application/octet-stream", bytes(range(256)), log_time=2, create_time=1)
    things.metadata_record("none", {})
    things.metadata_record("", {"": "empty", "empty": "", "\u00fc": "\U0001f41d"})
    yield "attachments_and_metadata", things.end()

    without = File()
    without.attachment("one", "text/plain", b"1")
    without.metadata_record("one", {"1": "1"})
    yield "attachments_and_metadata_without_index", without.end()


def damaged():
    """Files that are wrong, and what is said of them."""
    whole = FULL - {"ax", "mdx"}
    yield "wrong_data_crc", numbers(File(whole)).end(wrong_data_crc=True), "the CRC of the data section is wrong"
    yield "wrong_summary_crc", numbers(File(whole)).end(wrong_crc=True), "the CRC of the summary is wrong"
    yield "wrong_summary_start", numbers(File(whole)).end(wrong_start=1), "the footer does not point at the summary"
    wrong = {"message_count": 4}
    yield "wrong_message_count", numbers(File(whole)).end(**wrong), "the statistics do not count what the file holds"
    wrong = {"channel_message_counts": {1: 1, 2: 2}}
    yield "wrong_channel_counts", numbers(File(whole)).end(**wrong), "the statistics do not count what the file holds"
    wrong = {"chunk_count": 2}
    yield "wrong_chunk_count", numbers(File(whole)).end(**wrong), "the statistics do not count what the file holds"

    gap = of_all_kinds(File(whole))
    gap.groups[CHUNK_INDEX].pop()
    yield "a_chunk_that_is_not_indexed", gap.end(), "the summary does not index every chunk"

    packed = numbers(File(FULL, compression="lz4"))
    del packed.records[1:]
    yield "an_unknown_compression", packed.end(), "unknown compression 'lz4'"

    broken = File(FULL)
    broken.begin_chunk()
    broken.schema(1, "s")
    broken.channel(1, 1, "/one")
    broken.message(1, 0, 1, b"one")
    del broken.records[1:]
    broken.end_chunk(wrong_crc=True)
    yield "a_chunk_with_a_wrong_crc", broken.end(), "the CRC of a chunk is wrong"

    for name, second, what in [("schema", lambda f: f.schema(1, "other"), "schema 1 is defined twice"),
                               ("channel", lambda f: f.channel(1, 1, "/other"), "channel 1 is defined twice")]:
        twice = numbers(File())
        second(twice)
        twice.records.pop()
        yield f"a_{name}_that_changes", twice.end(), what

    cut = of_all_kinds(File(FULL)).end()
    (_, _), (_, second) = cut.groups[CHUNK_INDEX]
    frame, message = 49, 39  # bytes in front of a chunk's records, and those of a message
    del cut.bytes[second["chunk_start_offset"] + frame + message + 10:]
    del cut.records[[record["type"] for record in cut.records].index("Attachment") + 2:]
    yield "a_file_that_was_cut", cut, "the file ends inside a record"


def main():
    for old in [*FOLDER.glob("*.mcap"), *FOLDER.glob("*.json")]:
        old.unlink()
    for name, file, *damage in [*files(), *damaged()]:
        told = {"records": file.records, "meta": {"variant": {"features": sorted(file.features)}}}
        if damage:
            told["damage"] = damage[0]
        (FOLDER / f"{name}.mcap").write_bytes(file.bytes)
        lines = ",\n".join(json.dumps(each, ensure_ascii=False) for each in told.pop("records"))
        (FOLDER / f"{name}.json").write_text(f'{{"records": [\n{lines}\n], {json.dumps(told)[1:]}\n')


if __name__ == "__main__":
    main()
