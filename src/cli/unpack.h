/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file unpack.h
 * The files of a recording, unpacked into a folder of their own below TMPDIR, or else /tmp, as they
 * stood to one another.
 *
 * A process with such a folder holds a lock in it for its life.  The next one clears what others of
 * the same user have left behind because they were killed.
 */
#ifndef MUSTER_CLI_UNPACK_H
#define MUSTER_CLI_UNPACK_H

#include "mcap/mcap.h"
#include "report/report.h"

#include <limits.h>

enum { UNPACK_FOLDER_MAX = 1024 };

struct unpacked {
    char folder[UNPACK_FOLDER_MAX]; /* of all; experiment_root: folder/files; its rules:
                                       folder/library */
    char experiment[PATH_MAX];      /* its file in there; "": the simulator ran by hand */
    char world[PATH_MAX];           /* its file in there */
    struct report_source *files;    /* of the recording; their names live as long as its reader */
    uint32_t files_count;
    bool keeps; /* it stays when it is closed */
};

/**
 * Unpacks what a run was made of.
 *
 * @param file   the recording's path, for words
 * @param keeps  the folder is not removed at the end
 * @return MU_OK; MU_FAULT_FILE: it has names that are those of no files; MU_FAULT_OS: there is no
 *         room; both explained.  Close it in any case
 */
MU_MUST_USE mu_result unpack_open(struct unpacked *u, struct mcap_reader *reader, const char *file,
                                  bool keeps);

/**
 * Lets a program that is not in the recording stand where the run had it.
 *
 * @param path  absolute
 * @return MU_OK; MU_MALFORMED: it is no such path; MU_FAULT_OS, explained
 */
MU_MUST_USE mu_result unpack_program(struct unpacked *u, const char *path);

/** Removes the folder, unless it is kept. */
void unpack_close(struct unpacked *u);

/** @return the path that a file of the run had when it was recorded; its own path for others */
const char *unpack_path(const struct unpacked *u, const char *path);

#endif
