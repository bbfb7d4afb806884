/* SPDX-License-Identifier: Apache-2.0 */
/* Counts, in a recording, the facts that count as sensed, and those of them that no sensor makes:
 * sensed RUN.mcap prints "12345 0". */
#include "story/story.h"

#include <stdio.h>
#include <string.h>

static bool is_percept(const char *fact, size_t bytes)
{
    static const char *const relations[] = {"(position ", "(sonar ", "(laser ", "(blob ",
                                            "(fiducial "};
    for (size_t i = 0; i < sizeof relations / sizeof relations[0]; i++) {
        size_t len = strlen(relations[i]);
        if (len <= bytes && memcmp(fact, relations[i], len) == 0) {
            return true;
        }
    }
    return false;
}

int main(int argc, char **argv)
{
    static struct recording recording;
    struct mu_fault fault;
    long sensed = 0, wrong = 0;
    if (argc != 2 || recording_create(&recording, argv[1], &fault) != MU_OK ||
        recording_open(&recording, argv[1], &fault) != MU_OK) {
        fprintf(stderr, "usage: sensed RUN.mcap\n");
        return 2;
    }
    const struct minds *m = recording.minds;
    for (int32_t i = 0; i < m->lines_count; i++) {
        const struct minds_line *line = &m->lines[i];
        if (line->letter == '+' && line->cause != MINDS_NONE &&
            m->lines[line->cause].letter == 'S') {
            size_t bytes;
            const char *fact = minds_text(m, i, &bytes);
            bool good = is_percept(fact, bytes);
            sensed++;
            wrong += !good;
            if (!good) {
                fprintf(stderr, "%s %u: %.*s\n", m->robots[line->robot].name, line->step,
                        (int)bytes, fact);
            }
        }
    }
    printf("%ld %ld\n", sensed, wrong);
    recording_close(&recording);
    return 0;
}
