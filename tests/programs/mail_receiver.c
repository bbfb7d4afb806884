/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Takes mails and writes a line for each: "NUMBER SENDER CONTENT", with one write.
 *   mail_receiver DOMAIN NAME RECORD [BROKER [INTERFACE PEERS]]
 * The record is its memory: a later life goes on after the last whole line.
 */
#include "record.h"

#include <muster/muster.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    const int *record = self;
    record_line(*record, "%llu %s %s", (unsigned long long)mail->number, mail->src, mail->content);
}

/* @return the number at the start of the last line, 0 for an empty record */
static uint64_t last_number(int record)
{
    char tail[512];
    struct stat info;
    if (fstat(record, &info) != 0 || info.st_size == 0) {
        return 0;
    }
    off_t from = info.st_size > (off_t)sizeof tail - 1 ? info.st_size - (off_t)sizeof tail + 1 : 0;
    ssize_t len = pread(record, tail, sizeof tail - 1, from);
    if (len < 2) {
        return 0;
    }
    tail[len - 1] = '\0'; /* the newline of the last line */
    const char *line = strrchr(tail, '\n');
    return strtoull(line ? line + 1 : tail, NULL, 10);
}

int main(int argc, char **argv)
{
    if (argc < 4) {
        return 2;
    }
    int record = record_open(argv[3]);
    mu_process *p;
    mu_agent *a;
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10),
                                         .broker = argc > 4 ? argv[4] : NULL,
                                         .interface = argc > 6 ? argv[5] : NULL,
                                         .peer = argc > 6 ? argv[6] : NULL};
    struct mu_handlers handlers = {.self = &record, .on_mail = on_mail};
    if (record < 0 || mu_process_open(&p, &options) != MU_OK ||
        mu_agent_join(p, &a, argv[2], MU_KIND_AGENT, last_number(record), &handlers) != MU_OK) {
        return 4;
    }
    mu_result ran = mu_process_run(p);
    mu_process_close(p);
    return ran == MU_OK ? 0 : 1;
}
