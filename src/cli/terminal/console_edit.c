/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/terminal/terminal.h"

#include "core/text.h"
#include "operator/operator.h"

#include <errno.h>
#include <histedit.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>
#include <wchar.h>

enum { EDIT_HISTORY = 1000, EDIT_COLUMN = 26, EDIT_COLUMNS = 3 };

/* One terminal has one editor. */
struct console_edit {
    EditLine *line;
    History *history;
    HistEvent event;
    const struct console_edit_hooks *hooks;
    bool is_terminal;
    struct termios before; /* how it was */
    char file[PATH_MAX];   /* of the history; "": none */
};

static struct console_edit edit;

static char *edit_prompt(EditLine *line)
{
    static char prompt[256];
    (void)line;
    mu_text_copy(prompt, sizeof prompt, edit.hooks->prompt(edit.hooks->self));
    return prompt;
}

/* One character, of as many bytes as it has.  @return 1; 0: the end of input; -1: none */
static int edit_character(EditLine *line, wchar_t *to)
{
    (void)line;
    mbstate_t state = {0};
    for (;;) {
        char c;
        if (!edit.hooks->wait(edit.hooks->self)) {
            errno = EINTR;
            return -1;
        }
        ssize_t got = read(STDIN_FILENO, &c, 1);
        if (got <= 0) {
            return (int)got;
        }
        size_t used = mbrtowc(to, &c, 1, &state);
        if (used == (size_t)-2) {
            continue; /* more bytes belong to it */
        }
        if (used == (size_t)-1) {
            *to = L'?';
        }
        return 1;
    }
}

/* --- completion ------------------------------------------------------------------------------- */

static void matches_print(const char *words, struct complete_word w)
{
    struct complete_match match;
    const char *from = words;
    unsigned column = 0, listed = 0;
    putchar('\n');
    while (listed < COMPLETE_LISTED_MAX && complete_next(words, &from, w, &match)) {
        printf("%-*.*s", EDIT_COLUMN, (int)match.len, match.at);
        listed++;
        column = (column + 1) % EDIT_COLUMNS;
        fputs(column ? "" : "\n", stdout);
    }
    fputs(listed == COMPLETE_LISTED_MAX ? "..." : "", stdout);
    fputs(column ? "\n" : "", stdout);
    fflush(stdout);
}

static unsigned char edit_complete(EditLine *line, int key)
{
    (void)key;
    const LineInfo *info = el_line(line);
    struct complete_word w = complete_word(info->buffer, (size_t)(info->cursor - info->buffer));
    const char *words = edit.hooks->words(edit.hooks->self);
    char rest[COMPLETE_REST];
    size_t count = complete_rest(words, w, rest);
    if (count == 0) {
        return CC_REFRESH_BEEP;
    }
    if (!rest[0]) {
        matches_print(words, w);
        return CC_REDISPLAY;
    }
    return el_insertstr(line, rest) == 0 ? CC_REFRESH : CC_ERROR;
}

/* --- history ---------------------------------------------------------------------------------- */

static void history_place(char file[PATH_MAX])
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    char folder[PATH_MAX];
    struct mu_text t = mu_text_in(folder, sizeof folder);
    if (state && state[0] == '/') {
        mu_text_add(&t, state);
    } else if (home && home[0] == '/') {
        mu_text_format(&t, "%s/.local/state", home);
    }
    mu_text_add(&t, "/muster");
    bool there = folder[0] == '/' && folder[1] != 'm' && !t.cut;
    if (there && mkdir(folder, 0700) != 0 && errno != EEXIST) {
        there = false; /* the session has a history all the same */
    }
    mu_text_init(&t, file, PATH_MAX);
    if (there) {
        mu_text_format(&t, "%s/console_history", folder);
    }
}

/* Between two lines: what is typed ahead is shown once, by the editor, and kept as it is. */
static void terminal_hush(const struct console_edit *e)
{
    struct termios silent = e->before;
    silent.c_lflag &= ~(tcflag_t)(ECHO | ICANON);
    if (e->is_terminal) {
        tcsetattr(STDIN_FILENO, TCSANOW, &silent);
    }
}

struct console_edit *console_edit_open(const struct console_edit_hooks *hooks)
{
    edit = (struct console_edit){.hooks = hooks};
    edit.is_terminal = tcgetattr(STDIN_FILENO, &edit.before) == 0;
    terminal_hush(&edit);
    edit.line = el_init("muster", stdin, stdout, stderr);
    edit.history = history_init();
    if (!edit.line || !edit.history) {
        return NULL;
    }
    history(edit.history, &edit.event, H_SETSIZE, EDIT_HISTORY);
    history(edit.history, &edit.event, H_SETUNIQUE, 1);
    history_place(edit.file);
    if (edit.file[0]) {
        history(edit.history, &edit.event, H_LOAD, edit.file);
    }
    el_set(edit.line, EL_EDITOR, "emacs");
    el_set(edit.line, EL_SIGNAL, 0);
    el_set(edit.line, EL_HIST, history, edit.history);
    el_set(edit.line, EL_PROMPT_ESC, edit_prompt, '\1');
    el_set(edit.line, EL_GETCFN, edit_character);
    el_set(edit.line, EL_ADDFN, "muster-complete", "completes a word", edit_complete);
    el_set(edit.line, EL_BIND, "\t", "muster-complete", NULL);
    el_set(edit.line, EL_BIND, "^R", "em-inc-search-prev", NULL);
    el_source(edit.line, NULL);
    return &edit;
}

void console_edit_close(struct console_edit *e)
{
    if (e->file[0]) {
        history(e->history, &e->event, H_SAVE, e->file);
    }
    history_end(e->history);
    el_end(e->line);
    if (e->is_terminal) {
        tcsetattr(STDIN_FILENO, TCSANOW, &e->before);
    }
}

const char *console_edit_line(struct console_edit *e)
{
    int count = 0;
    const char *line = el_gets(e->line, &count);
    terminal_hush(e); /* the editor has undone it */
    if (!line || count <= 0) {
        return NULL;
    }
    if (line[strspn(line, " \t\n")]) {
        history(e->history, &e->event, H_ENTER, line);
    }
    return line;
}

void console_edit_refresh(struct console_edit *e)
{
    el_set(e->line, EL_REFRESH);
}
