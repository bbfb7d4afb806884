/* SPDX-License-Identifier: Apache-2.0 */
/* muster console: a person looks into an agent, and has it do lines, while the world goes on. */
#include "cli/terminal/terminal.h"
#include "cli/verbs.h"
#include "core/clock.h"
#include "core/exits.h"
#include "muster/memory.h"
#include "operator/operator.h"

#include <locale.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const int64_t ROUND_NS = 20000000;
static const uint64_t GOODBYE_NS = 300000000;
static const int ROUND_MS = 50;
static const uint64_t SILENCE_NS = 3000000000; /* a busy machine may be that busy */
static const uint64_t WORDS_PATIENCE_NS = 400000000;

enum { INPUT_BYTES = 4096 };

struct console {
    struct operator_options options;
    struct mu_option_list lines; /* -c; none: from standard input */
    double watch_s;
    struct operator op;
    struct operator_hooks hooks;
    struct console_link link;
    struct forms forms;
    struct console_edit *edit; /* NULL: no terminal */
    bool colors;               /* standard output is a terminal that wants them */
    bool editing;              /* the prompt stands on the screen */
    bool hidden;               /* it stood there, and something was printed over it */
    bool at_margin;            /* what was printed last ended with a line */
    bool over;                 /* the person leaves, or there is no agent to talk to */
    uint64_t heard_ns;         /* when there was a broker last */
    enum mu_state state;       /* that the prompt shows */
};

static volatile sig_atomic_t interrupted; /* the signal that came, or 0 */

static void interrupt_note(int number)
{
    interrupted = number;
}

/* --- the screen ------------------------------------------------------------------------------- */

static void text_print(struct console *c, const char *text)
{
    size_t len = strlen(text);
    answer_text_print(stdout, text);
    c->at_margin = len > 0 ? text[len - 1] == '\n' : c->at_margin;
}

static void margin_reach(struct console *c)
{
    if (!c->at_margin) {
        putchar('\n');
    }
    c->at_margin = true;
}

static void prompt_hide(struct console *c)
{
    if (c->editing && !c->hidden) {
        fputs("\r\033[K", stdout);
        c->hidden = true;
    }
}

static void on_show(void *self, enum console_kind kind, uint64_t line, const char *text)
{
    (void)line;
    static const char *const colors[] = {
        [CONSOLE_ANSWER] = "", [CONSOLE_FAILURE] = "\033[31m", [CONSOLE_TRACE] = "\033[2m"};
    struct console *c = self;
    prompt_hide(c);
    if (kind == CONSOLE_NOTE) {
        margin_reach(c);
        fflush(stdout);
        answer_text_print(stderr, text);
        fputc('\n', stderr);
        return;
    }
    bool colored = c->colors && colors[kind][0];
    fputs(colored ? colors[kind] : "", stdout);
    text_print(c, text);
    fputs(colored ? "\033[0m" : "", stdout);
    fflush(stdout);
}

static void note(struct console *c, const char *text)
{
    on_show(c, CONSOLE_NOTE, 0, text);
}

/* The prompt comes back below what was printed, and when the state has changed. */
static void prompt_restore(struct console *c)
{
    enum mu_state state = console_link_state(&c->link);
    if (!c->editing || (!c->hidden && state == c->state)) {
        return;
    }
    prompt_hide(c);
    margin_reach(c);
    fflush(stdout);
    c->hidden = false;
    console_edit_refresh(c->edit);
}

static const char *on_prompt(void *self)
{
    static const char *const colors[] = {[MU_STANDBY] = "36",
                                         [MU_RUNNING] = "32",
                                         [MU_SUSPENDED] = "33",
                                         [MU_MOVING] = "35",
                                         [MU_GONE] = "31"};
    static char prompt[128];
    struct console *c = self;
    c->state = console_link_state(&c->link);
    const char *name = c->link.agent, *state = mu_state_text(c->state);
    if (forms_are_open(&c->forms)) {
        snprintf(prompt, sizeof prompt, "%*s ", (int)(strlen(name) + strlen(state)) + 2, "...");
    } else if (c->colors) {
        snprintf(prompt, sizeof prompt, "\1\033[1m\1%s\1\033[0;%sm\1 %s\1\033[0m\1> ", name,
                 colors[c->state], state);
    } else {
        snprintf(prompt, sizeof prompt, "%s %s> ", name, state);
    }
    return prompt;
}

/* --- waiting ---------------------------------------------------------------------------------- */

static void round_spin(struct console *c, int64_t timeout_ns)
{
    if (mu_process_spin(c->op.process, timeout_ns) != MU_OK) {
        c->over = true;
    }
    console_link_round(&c->link);
    c->heard_ns = mu_process_has_broker(c->op.process) ? mu_clock_ns() : c->heard_ns;
    bool is_alone = mu_clock_ns() - c->heard_ns > SILENCE_NS;
    if (!c->over && (is_alone || c->op.refused)) {
        note(c, is_alone ? "muster console: the broker is gone"
                         : "muster console: it was away, and another one has its name now");
        c->link.code = MU_EXIT_DDS;
        c->over = true;
    }
}

/* @return whether something is typed, or comes through the pipe */
static bool input_ready(int timeout_ms, int wake_fd)
{
    struct pollfd fds[2] = {{.fd = STDIN_FILENO, .events = POLLIN},
                            {.fd = wake_fd, .events = POLLIN}};
    int ready = poll(fds, wake_fd >= 0 ? 2 : 1, timeout_ms);
    return ready > 0 && fds[0].revents;
}

static bool input_await(struct console *c)
{
    int wake_fd = mu_process_wake_fd(c->op.process);
    while (!c->over && !interrupted) {
        if (input_ready(ROUND_MS, wake_fd)) {
            return true;
        }
        round_spin(c, 0);
        prompt_restore(c);
    }
    return false;
}

static bool on_wait(void *self)
{
    struct console *c = self;
    c->editing = true;
    bool ready = input_await(c);
    c->editing = false;
    return ready;
}

/* Waits until at most so many lines have no answer.  @param hurried  not when more is typed */
static void answers_await(struct console *c, size_t most, bool hurried)
{
    uint64_t patience_ns = (uint64_t)(c->options.wait_s * 1e9);
    while (c->link.pending_count > most && !c->over) {
        if (interrupted || (hurried && input_ready(0, -1))) {
            return;
        }
        if (mu_clock_ns() - c->link.heard_ns > patience_ns) {
            note(c, "[no answer; --wait says how long a console waits]");
            console_link_forget(&c->link);
            c->link.code = MU_EXIT_TIME;
            return;
        }
        round_spin(c, ROUND_NS);
    }
}

/* --- lines ------------------------------------------------------------------------------------ */

static bool form_leaves(const char *form)
{
    return strcmp(form, "(exit)") == 0 || strcmp(form, "(quit)") == 0;
}

static void form_send(struct console *c, const char *form)
{
    if (form_leaves(form)) {
        c->over = true;
        return;
    }
    if (!words_are_utf8(form)) {
        note(c, "muster console: expected UTF-8");
        c->link.failures++;
        return;
    }
    while (!c->over && !interrupted && console_link_line(&c->link, form, NULL) != MU_OK) {
        answers_await(c, c->link.pending_max / 2, false);
        round_spin(c, 0); /* also when none waits, and the mail had no room */
    }
}

/* Sends the forms that end in a text; what is open goes on with the next one. */
static void text_take(struct console *c, const char *text)
{
    enum forms_found found;
    while (!c->over && (found = forms_next(&c->forms, &text)) != FORMS_MORE) {
        if (found == FORMS_READY) {
            form_send(c, c->forms.text);
        } else {
            note(c, found == FORMS_EXTRA ? "muster console: a ')' too many"
                                         : "muster console: expected at most 16384 bytes");
            c->link.failures++;
        }
    }
}

static const char *on_words(void *self)
{
    struct console *c = self;
    uint64_t until_ns = mu_clock_ns() + WORDS_PATIENCE_NS;
    if (c->link.words_stale) {
        console_link_ask_words(&c->link);
    }
    while (c->link.words_asked && !c->over && mu_clock_ns() < until_ns) {
        round_spin(c, ROUND_NS);
    }
    return c->link.words;
}

/* --- the three ways of reading ---------------------------------------------------------------- */

static void interrupt_take(struct console *c)
{
    c->over = c->over || (interrupted && interrupted != SIGINT);
    if (interrupted == SIGINT) {
        interrupted = 0;
        forms_clear(&c->forms);
        console_link_forget(&c->link);
        fputs("^C\n", stdout);
        c->at_margin = true;
    }
}

static void terminal_read(struct console *c)
{
    struct console_edit_hooks hooks = {c, on_prompt, on_wait, on_words};
    c->edit = console_edit_open(&hooks);
    if (!c->edit) {
        note(c, "muster console: lines cannot be edited on this terminal");
        c->link.code = MU_EXIT_DDS;
        return;
    }
    printf("A console on %s: a line of CLIPS, or (exit); TAB completes.\n", c->link.agent);
    c->at_margin = true;
    while (!c->over) {
        const char *line = console_edit_line(c->edit);
        if (!line && !interrupted) {
            break; /* the end of input */
        }
        if (line) {
            text_take(c, line);
            answers_await(c, 0, true);
            margin_reach(c);
        }
        interrupt_take(c);
    }
    margin_reach(c);
    putchar('\n');
    console_edit_close(c->edit);
}

/* Without a terminal an interrupt ends the console. */
static void pipe_read(struct console *c)
{
    static char bytes[INPUT_BYTES + 1];
    ssize_t got = 1;
    while (got > 0 && input_await(c)) {
        got = read(STDIN_FILENO, bytes, INPUT_BYTES);
        size_t len = 0;
        for (ssize_t i = 0; i < got; i++) { /* a zero would end the text */
            bytes[len] = bytes[i];
            len += bytes[i] != '\0';
        }
        bytes[len] = '\0';
        text_take(c, bytes);
        round_spin(c, 0);
    }
    text_take(c, "\n");
    if (forms_are_open(&c->forms) && !interrupted) {
        note(c, "muster console: a parenthesis is never closed");
        c->link.failures++;
    }
}

/* What rules print, and what is watched, for a while. */
static void watch_on(struct console *c)
{
    uint64_t until_ns = mu_clock_ns() + (uint64_t)(c->watch_s * 1e9);
    while (!c->over && !interrupted && mu_clock_ns() < until_ns) {
        round_spin(c, ROUND_NS);
    }
}

static void lines_do(struct console *c)
{
    if (c->watch_s > 0.0) {
        console_link_attach(&c->link);
    }
    for (size_t i = 0; i < c->lines.count; i++) {
        text_take(c, c->lines.items[i]);
        text_take(c, "\n");
    }
    if (c->lines.count == 0) {
        pipe_read(c);
    }
    answers_await(c, 0, false);
    watch_on(c);
    margin_reach(c);
}

/* --- the verb --------------------------------------------------------------------------------- */

static void on_mail(void *self, const struct mu_mail *mail)
{
    console_link_mail(&((struct console *)self)->link, mail);
}

static void on_receipt(void *self, uint64_t first_seq, uint64_t last_seq, enum mu_outcome outcome)
{
    console_link_receipt(&((struct console *)self)->link, first_seq, last_seq, outcome);
}

static void on_glance(void *self, uint64_t number, enum probe_end end, const char *text)
{
    console_link_glance(&((struct console *)self)->link, number, end, text);
}

/* Joins as a further operator, and looks for the agent.  @return the exit code, explained */
static int console_join(struct console *c, const char *agent)
{
    c->hooks = (struct operator_hooks){c, on_mail, on_receipt};
    c->options.hooks = &c->hooks;
    c->options.only_reads = true;
    int code = operator_join(&c->op, &c->options, "console");
    if (code != MU_EXIT_DONE) {
        return code;
    }
    const struct mu_member *m = mu_process_lookup(c->op.process, agent);
    if (!m || m->state == MU_GONE) {
        fprintf(stderr, "muster console: %s: %s; muster ps lists all agents\n", agent,
                m ? "absent" : "no such agent");
        return MU_EXIT_NO_AGENT;
    }
    probes_hear(c->op.agent, on_glance, c);
    console_link_init(&c->link, c->op.process, c->op.agent, agent);
    return MU_EXIT_DONE;
}

/* Says goodbye and leaves. */
static void console_leave(struct console *c)
{
    if (console_link_detach(&c->link, &c->op.seq) == MU_OK) {
        uint64_t until_ns = mu_clock_ns() + GOODBYE_NS;
        c->op.answered_for = false;
        while (!c->op.answered_for && mu_clock_ns() < until_ns &&
               mu_process_spin(c->op.process, ROUND_NS) == MU_OK) {
        }
    }
    operator_leave(&c->op);
}

static int console_live(struct console *c, const char *agent)
{
    bool terminal = c->lines.count == 0 && isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
    const char *term = getenv("TERM"), *plain = getenv("NO_COLOR");
    c->options.stays = terminal || c->watch_s > 0.0;
    int code = console_join(c, agent);
    if (code != MU_EXIT_DONE) {
        return code;
    }
    c->heard_ns = mu_clock_ns();
    struct sigaction note_it = {.sa_handler = interrupt_note};
    sigaction(SIGINT, &note_it, NULL);
    sigaction(SIGTERM, &note_it, NULL); /* the terminal is to be as it was */
    sigaction(SIGHUP, &note_it, NULL);
    c->colors = terminal && term && strcmp(term, "dumb") != 0 && !(plain && plain[0]);
    if (terminal) {
        console_link_attach(&c->link);
        console_link_ask_words(&c->link);
        terminal_read(c);
    } else {
        lines_do(c);
    }
    console_leave(c);
    if (interrupted) {
        return MU_EXIT_INTERRUPTED;
    }
    return c->link.code == MU_EXIT_DONE && c->link.failures > 0 && !terminal ? MU_EXIT_UNDELIVERED
                                                                             : c->link.code;
}

/* @return whether a line of -c has whole forms; said if not */
static bool line_check(struct console *c, const char *at)
{
    enum forms_found found;
    while ((found = forms_next(&c->forms, &at)) == FORMS_READY) {
    }
    bool open =
        found == FORMS_MORE && forms_are_open(&c->forms) && (c->forms.depth > 0 || c->forms.string);
    const char *wrong = open ? "a parenthesis or a string is never closed" : NULL;
    wrong = found == FORMS_EXTRA ? "a ')' too many" : wrong;
    wrong = found == FORMS_LONG ? "expected at most 16384 bytes" : wrong;
    if (wrong) {
        fprintf(stderr, "muster console -c: %s\n", wrong);
    }
    forms_clear(&c->forms);
    return !wrong;
}

static bool lines_check(struct console *c)
{
    bool good = true;
    for (size_t i = 0; i < c->lines.count && good; i++) {
        good = line_check(c, c->lines.items[i]);
    }
    return good;
}

int console_verb(int argc, char **argv)
{
    struct console *c = mu_startup_alloc(sizeof *c);
    c->at_margin = true;
    c->link.self = c;
    c->link.show = on_show;
    setlocale(LC_CTYPE, "");
    struct mu_option table[] = {
        OPERATOR_OPTIONS(c->options),
        MU_LIST("command", "LINE", c->lines,
                "do this line, print its answer, and leave; may stand several times",
                .letter = 'c'),
        MU_REAL("wait", "S", c->options.wait_s, "wait so long for an answer", .fallback = "5",
                .max = 1e6),
        MU_REAL("watch", "S", c->watch_s,
                "without a terminal: also show what rules print and what is watched, and go on "
                "with that for so long behind the last line",
                .max = 1e6),
    };
    static struct mu_options o;
    o = (struct mu_options){.program = "muster console",
                            .usage = "NAME [OPTION...]",
                            .about = "A console on an agent: CLIPS lines from the terminal, or "
                                     "from standard input.",
                            MU_OPTION_TABLE(table),
                            .one = "agent",
                            .example = "red"};
    mu_result parsed = operator_parse(&o, argc, argv, &c->options);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    bool good = words_name_check("muster console", "an agent", o.words[0]) && lines_check(c);
    return good ? console_live(c, o.words[0]) : MU_EXIT_USAGE;
}
