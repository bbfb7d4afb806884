/* SPDX-License-Identifier: Apache-2.0 */
/* What shells are told of a verb's options: each program prints its own table. */
#include "cli/help/completion.h"

#include "core/exits.h"
#include "core/paths.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { DUMP_MAX = 64 * 1024, DUMP_FIELDS = 7 };

/* The child's answer to `muster VERB --dump-options`.  @return whether it gave one */
static bool dump_read(const char *verb, char *text, size_t size)
{
    char path[PATH_MAX];
    int ends[2];
    if (!mu_path_program(path, sizeof path, "muster") || pipe(ends) != 0) {
        return false;
    }
    pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        execl(path, "muster", verb, "--dump-options", (char *)NULL);
        _exit(MU_EXIT_CRASH);
    }
    close(ends[1]);
    size_t len = 0;
    for (ssize_t got = 1; child > 0 && got > 0 && len<size - 1; len += got> 0 ? got : 0) {
        got = read(ends[0], text + len, size - 1 - len);
    }
    close(ends[0]);
    text[len] = '\0';
    int status = 0;
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

/* What the value of an option is completed with: a kind of word, see struct verb. */
static const char *value_kind(const char *name, const char *unit)
{
    static const struct {
        const char *name, *unit, *kind; /* name NULL: any */
    } kinds[] = {
        {"rules", "FILE", "rules"},   {"world", "FILE", "world"}, {NULL, "FILE", "file"},
        {NULL, "DIR", "folder"},      {NULL, "D", "run"},         {"as", "NAME", "agent"},
        {"broker", "NAME", "broker"}, {NULL, "G", "group"},       {"broker", "[NAME]", "broker"},
    };
    if (unit[0] == '\0' || strchr(unit, '|')) {
        return unit;
    }
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        bool fits = !kinds[i].name || strcmp(kinds[i].name, name) == 0;
        if (fits && strcmp(kinds[i].unit, unit) == 0) {
            return kinds[i].kind;
        }
    }
    return "-";
}

/* Takes the next line of a dump apart.  @return false: there is none */
static bool option_next(char **text, struct completion_option *o)
{
    char *field[DUMP_FIELDS], *line = strsep(text, "\n");
    for (size_t i = 0; i < DUMP_FIELDS; i++) {
        field[i] = strsep(&line, "\t");
        if (!field[i]) {
            return false;
        }
    }
    *o = (struct completion_option){.name = field[0],
                                    .letter = field[1],
                                    .unit = field[2],
                                    .kind = value_kind(field[0], field[2]),
                                    .is_many = field[3][0] != '\0',
                                    .help = field[6]};
    return true;
}

size_t completion_options(const struct verb *verb, struct completion_option *options)
{
    static char dump[DUMP_MAX];
    size_t count = 0;
    if (!dump_read(verb->name, dump, sizeof dump)) {
        fprintf(stderr, "muster completion: the options of %s cannot be had\n", verb->name);
        return 0;
    }
    for (char *text = dump;
         count < COMPLETION_OPTIONS_MAX && option_next(&text, &options[count]);) {
        count++;
    }
    return count;
}

void completion_quote(const char *text, const char *quoted, const char *as)
{
    for (; *text; text++) {
        if (*text == '\'') {
            fputs(as, stdout);
        } else {
            printf(strchr(quoted, *text) ? "\\%c" : "%c", *text);
        }
    }
}
