/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mcap_format.h
 * The words of an MCAP file (version 1.0): opcodes, the magic, how long the parts of records are.
 *
 * A file is the magic, a header, data, a summary, a footer, the magic.  All of it is records: an
 * opcode, eight bytes of length, and so many bytes.  Numbers are little-endian.
 */
#ifndef MUSTER_MCAP_MCAP_FORMAT_H
#define MUSTER_MCAP_MCAP_FORMAT_H

#include <stdint.h>

enum mcap_op {
    MCAP_HEADER = 0x01,
    MCAP_FOOTER = 0x02,
    MCAP_SCHEMA = 0x03,
    MCAP_CHANNEL = 0x04,
    MCAP_MESSAGE = 0x05,
    MCAP_CHUNK = 0x06,
    MCAP_MESSAGE_INDEX = 0x07,
    MCAP_CHUNK_INDEX = 0x08,
    MCAP_ATTACHMENT = 0x09,
    MCAP_ATTACHMENT_INDEX = 0x0A,
    MCAP_STATISTICS = 0x0B,
    MCAP_METADATA = 0x0C,
    MCAP_METADATA_INDEX = 0x0D,
    MCAP_SUMMARY_OFFSET = 0x0E,
    MCAP_DATA_END = 0x0F,
};

enum {
    MCAP_MAGIC_BYTES = 8,
    MCAP_HEAD_BYTES = 9,          /* opcode and length */
    MCAP_MESSAGE_BYTES = 22,      /* of a message before its data */
    MCAP_CHUNK_BYTES = 40,        /* of an uncompressed chunk before its records */
    MCAP_CHUNK_CRC_AT = 24,       /* in a chunk */
    MCAP_FOOTER_BYTES = 20,       /* of a footer */
    MCAP_FOOTER_CRC_AT = 9 + 16,  /* from its opcode on: the CRC goes as far */
    MCAP_INDEX_ENTRY_BYTES = 16,  /* of a message index */
    MCAP_TAIL_BYTES = 9 + 20 + 8, /* footer and magic */
};

#define MCAP_MAGIC ((const uint8_t *)"\x89MCAP0\r\n")

#endif
