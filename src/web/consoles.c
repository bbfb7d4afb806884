/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include "core/clock.h"
#include "core/name.h"
#include "muster/memory.h"
#include "operator/operator.h"

#include <stdio.h>
#include <string.h>

static const uint64_t PATIENCE_NS = 10000000000;
static const uint64_t WORDS_NS = 500000000;        /* old words are better than later ones */
static const uint64_t FIRST_WORDS_NS = 3000000000; /* but none are of no use */
static const unsigned ATTEMPTS_MAX = 64;

/* --- what agents say -------------------------------------------------------------------------- */

static struct console_ask *ask_find(struct console *c, uint64_t line)
{
    for (size_t i = 0; i < CONSOLES_ASKS_MAX; i++) {
        if (c->asks[i].line == line) {
            return &c->asks[i];
        }
    }
    return NULL;
}

static void said_write(struct console *c, enum console_kind kind, uint64_t ask, const char *text)
{
    static const char *const kinds[] = {[CONSOLE_ANSWER] = "answer",
                                        [CONSOLE_FAILURE] = "failure",
                                        [CONSOLE_TRACE] = "trace",
                                        [CONSOLE_NOTE] = "note"};
    struct mu_json *j = viewers_begin(c->all->viewers, "said");
    mu_json_object(j, NULL);
    mu_json_string(j, "agent", c->name);
    mu_json_string(j, "kind", kinds[kind]);
    mu_json_uint(j, "ask", ask);
    mu_json_string(j, "text", text);
    mu_json_end(j);
    viewers_end(c->all->viewers);
}

static void watchers_tell(struct console *c)
{
    struct viewers *v = c->all->viewers;
    for (size_t i = 0; i < VIEWERS_MAX; i++) {
        struct viewer *to = c->watchers[i] ? viewers_find(v, c->watchers[i]) : NULL;
        if (to) {
            viewers_send(v, to);
        }
    }
}

/* What belongs to a line goes to the page that typed it, the rest to all that watch. */
static void on_show(void *self, enum console_kind kind, uint64_t line, const char *text)
{
    struct console *c = self;
    const struct console_ask *ask = line ? ask_find(c, line) : NULL;
    struct viewer *to = ask ? viewers_find(c->all->viewers, ask->viewer) : NULL;
    if (line && !to) {
        return; /* the page that asked has left */
    }
    said_write(c, kind, ask ? ask->number : 0, text);
    if (to) {
        viewers_send(c->all->viewers, to);
    } else {
        watchers_tell(c);
    }
}

static bool ask_goes_on(const struct console *c, const struct console_ask *of)
{
    for (size_t i = 0; i < CONSOLES_ASKS_MAX; i++) {
        const struct console_ask *a = &c->asks[i];
        if (a->line && a->viewer == of->viewer && a->number == of->number) {
            return true;
        }
    }
    return false;
}

/* A text of several forms has ended with the last of them. */
static void on_ended(void *self, uint64_t line, bool good)
{
    struct console *c = self;
    struct console_ask *ask = ask_find(c, line);
    struct viewer *to = ask ? viewers_find(c->all->viewers, ask->viewer) : NULL;
    if (!ask) {
        return;
    }
    ask->line = 0;
    if (!to || ask_goes_on(c, ask)) {
        return;
    }
    struct mu_json *j = viewers_begin(c->all->viewers, "ended");
    mu_json_object(j, NULL);
    mu_json_string(j, "agent", c->name);
    mu_json_uint(j, "ask", ask->number);
    mu_json_bool(j, "good", good);
    mu_json_end(j);
    viewers_end(c->all->viewers);
    viewers_send(c->all->viewers, to);
}

/* --- the agent that speaks for all pages ------------------------------------------------------ */

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct consoles *c = self;
    (void)reason;
    bool held = mu_agent_refusal(a) == MU_REFUSAL_NAME_HELD;
    c->state = accepted ? CONSOLES_IN : CONSOLES_REFUSED;
    if (!accepted && held && c->attempt < ATTEMPTS_MAX) {
        c->attempt++;
        c->state = CONSOLES_OUT;
    }
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    struct consoles *c = self;
    (void)a;
    for (size_t i = 0; i < CONSOLES_MAX; i++) {
        if (c->all[i].used) {
            console_link_mail(&c->all[i].link, mail);
        }
    }
}

static void on_receipt(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome)
{
    struct consoles *c = self;
    (void)a;
    for (size_t i = 0; i < CONSOLES_MAX; i++) {
        if (c->all[i].used) {
            console_link_receipt(&c->all[i].link, first_seq, last_seq, outcome);
        }
    }
}

static void on_glance(void *self, uint64_t number, enum probe_end end, const char *text)
{
    struct consoles *c = self;
    for (size_t i = 0; i < CONSOLES_MAX; i++) {
        if (c->all[i].used) {
            console_link_glance(&c->all[i].link, number, end, text);
        }
    }
}

/* What was sent in another name has its answers there. */
static void links_hand_over(struct consoles *c)
{
    for (size_t i = 0; i < CONSOLES_MAX; i++) {
        struct console_link *l = &c->all[i].link;
        if (c->all[i].used && l->asker != c->agent) {
            console_link_forget(l);
            l->asker = c->agent;
            l->attached = false;
        }
    }
}

static void agent_join(struct consoles *c)
{
    char name[MU_NAME_MAX + 1];
    if (c->agent) {
        mu_agent_set_state(c->agent, MU_GONE);
    }
    reader_name(name, c->attempt, true);
    mu_result joined = mu_agent_join(c->process, &c->agent, name, MU_KIND_SPECIAL, 0, &c->handlers);
    if (joined != MU_OK) { /* one that leaves still has its place */
        c->agent = NULL;
        return;
    }
    mu_agent_decline_broadcasts(c->agent);
    probes_hear(c->agent, on_glance, c);
    links_hand_over(c);
    c->state = CONSOLES_JOINING;
}

static enum consoles_outcome agent_ready(struct consoles *c)
{
    if (c->state == CONSOLES_OUT) {
        agent_join(c);
    }
    if (!mu_process_has_broker(c->process)) { /* it looks for one only when an agent is to join */
        return CONSOLES_NO_BROKER;
    }
    if (c->state == CONSOLES_REFUSED) {
        return CONSOLES_DENIED;
    }
    return c->state == CONSOLES_IN ? CONSOLES_DONE : CONSOLES_NOT_YET;
}

/* --- one console for each agent --------------------------------------------------------------- */

static bool is_watched(const struct console *c)
{
    for (size_t i = 0; i < VIEWERS_MAX; i++) {
        if (c->watchers[i]) {
            return true;
        }
    }
    return false;
}

/* @return a place: a free one, else the one that was not needed for longest; NULL: none */
static struct console *place_find(struct consoles *c)
{
    struct console *oldest = NULL;
    for (size_t i = 0; i < CONSOLES_MAX; i++) {
        struct console *k = &c->all[i];
        if (!k->used) {
            return k;
        }
        bool idle = k->link.pending_count == 0 && !is_watched(k) && !k->link.attached;
        if (idle && (!oldest || k->used_ns < oldest->used_ns)) {
            oldest = k;
        }
    }
    return oldest;
}

static struct console *console_find(struct consoles *c, const char *agent)
{
    for (size_t i = 0; i < CONSOLES_MAX; i++) {
        if (c->all[i].used && strcmp(c->all[i].name, agent) == 0) {
            return &c->all[i];
        }
    }
    return NULL;
}

/* A late answer is no answer to a new line, also when the agent has had another place meanwhile.
 * @return the highest number that a line has had */
static uint64_t lines_highest(const struct consoles *c)
{
    uint64_t highest = 0;
    for (size_t i = 0; i < CONSOLES_MAX; i++) {
        uint64_t lines = c->all[i].link.lines;
        highest = lines > highest ? lines : highest;
    }
    return highest;
}

static void console_begin(struct console *k, struct consoles *c, const char *agent)
{
    uint64_t lines = lines_highest(c);
    memset(k, 0, sizeof *k);
    k->used = true;
    k->all = c;
    mu_text_copy(k->name, sizeof k->name, agent);
    k->link.self = k;
    k->link.show = on_show;
    k->link.ended = on_ended;
    k->link.lines = lines;
    console_link_init(&k->link, c->process, c->agent, k->name);
}

static struct console *console_for(struct consoles *c, const char *agent)
{
    struct console *k = console_find(c, agent);
    if (!k && (k = place_find(c))) {
        console_begin(k, c, agent);
    }
    if (k) {
        k->used_ns = mu_clock_ns();
    }
    return k;
}

/* @return how many lines the forms of a text are; < 0: it has no end, or too many */
static int forms_count(struct forms *forms, const char *text)
{
    int count = 0;
    enum forms_found found;
    forms_clear(forms);
    while ((found = forms_next(forms, &text)) == FORMS_READY) {
        count++;
    }
    const char *end = "\n"; /* a word ends with its line */
    if (found == FORMS_MORE && (found = forms_next(forms, &end)) == FORMS_READY) {
        count++;
        found = FORMS_MORE;
    }
    bool open = forms_are_open(forms);
    forms_clear(forms);
    return found != FORMS_MORE || open ? -1 : count;
}

static enum consoles_outcome form_send(struct console *k, const char *form, uint64_t viewer,
                                       uint64_t number)
{
    uint64_t line;
    struct console_ask *ask = ask_find(k, 0);
    if (!ask || console_link_line(&k->link, form, &line) != MU_OK) {
        return CONSOLES_BUSY;
    }
    *ask = (struct console_ask){line, viewer, number};
    return CONSOLES_DONE;
}

/* The last word ends with the text.  @return whether there is one */
static bool form_next(struct forms *forms, const char **text)
{
    const char *end = "\n";
    return forms_next(forms, text) == FORMS_READY || forms_next(forms, &end) == FORMS_READY;
}

static enum consoles_outcome forms_send(struct console *k, const char *text, uint64_t viewer,
                                        uint64_t number)
{
    struct forms *forms = &k->all->forms;
    enum consoles_outcome sent = CONSOLES_DONE;
    unsigned count = 0;
    forms_clear(forms);
    while (sent == CONSOLES_DONE && form_next(forms, &text)) {
        sent = form_send(k, forms->text, viewer, number);
        count += sent == CONSOLES_DONE;
    }
    forms_clear(forms);
    return sent != CONSOLES_DONE && count > 0 ? CONSOLES_PARTLY : sent;
}

enum consoles_outcome consoles_say(struct consoles *c, const char *agent, const char *text,
                                   uint64_t viewer, uint64_t number)
{
    enum consoles_outcome ready = mu_name_valid(agent) ? agent_ready(c) : CONSOLES_NO_NAME;
    int count = ready == CONSOLES_DONE ? forms_count(&c->forms, text) : 0;
    if (ready != CONSOLES_DONE) {
        return ready;
    }
    if (count <= 0) {
        return CONSOLES_NO_FORM;
    }
    struct console *k = console_for(c, agent);
    if (k && (size_t)count > k->link.pending_max) {
        return CONSOLES_MANY;
    }
    if (!k || k->link.pending_count + (size_t)count > k->link.pending_max) {
        return CONSOLES_BUSY;
    }
    return forms_send(k, text, viewer, number);
}

/* --- words that are completed ------------------------------------------------------------------
 */

static void matches_write(struct mu_json *j, const char *words, struct complete_word w)
{
    char name[COMPLETE_REST];
    const char *from = words;
    struct complete_match match;
    mu_json_list(j, "words");
    for (int n = 0; n < COMPLETE_LISTED_MAX && complete_next(words, &from, w, &match); n++) {
        snprintf(name, sizeof name, "%.*s", (int)match.len, match.at);
        mu_json_string(j, NULL, name);
    }
    mu_json_end(j);
}

static void tab_end(struct console *k, struct console_tab *tab)
{
    char rest[COMPLETE_REST];
    struct viewers *v = k->all->viewers;
    struct viewer *to = viewers_find(v, tab->viewer);
    struct complete_word w = complete_word(tab->word, strlen(tab->word));
    size_t count = complete_rest(k->link.words, w, rest);
    tab->viewer = 0;
    if (!to) {
        return;
    }
    struct mu_json *j = viewers_begin(v, "completed");
    mu_json_object(j, NULL);
    mu_json_string(j, "agent", k->name);
    mu_json_uint(j, "ask", tab->number);
    mu_json_uint(j, "count", count);
    mu_json_string(j, "rest", rest);
    matches_write(j, rest[0] ? "" : k->link.words, w);
    mu_json_end(j);
    viewers_end(v);
    viewers_send(v, to);
}

static void tabs_round(struct console *k)
{
    uint64_t patience_ns = k->link.words_len > 0 ? WORDS_NS : FIRST_WORDS_NS;
    for (size_t i = 0; i < CONSOLES_TABS_MAX; i++) {
        struct console_tab *tab = &k->tabs[i];
        bool waits = k->link.words_asked > 0 && mu_clock_ns() - tab->since_ns < patience_ns;
        if (tab->viewer && !waits) {
            tab_end(k, tab);
        }
    }
}

static struct console_tab *tab_find(struct console *k)
{
    for (size_t i = 0; i < CONSOLES_TABS_MAX; i++) {
        if (!k->tabs[i].viewer) {
            return &k->tabs[i];
        }
    }
    return NULL;
}

enum consoles_outcome consoles_complete(struct consoles *c, const char *agent, const char *line,
                                        uint64_t viewer, uint64_t number)
{
    enum consoles_outcome ready = mu_name_valid(agent) ? agent_ready(c) : CONSOLES_NO_NAME;
    struct console *k = ready == CONSOLES_DONE ? console_for(c, agent) : NULL;
    struct console_tab *tab = k ? tab_find(k) : NULL;
    if (!tab) {
        return ready == CONSOLES_DONE ? CONSOLES_BUSY : ready;
    }
    size_t len = strlen(line),
           behind = len >= CONSOLES_TAB_BYTES ? len + 1 - CONSOLES_TAB_BYTES : 0;
    *tab = (struct console_tab){.viewer = viewer, .number = number, .since_ns = mu_clock_ns()};
    mu_text_copy(tab->word, sizeof tab->word, line + behind);
    if (k->link.words_stale || k->link.words_len == 0) {
        console_link_ask_words(&k->link);
    }
    return CONSOLES_DONE;
}

/* --- watchers --------------------------------------------------------------------------------- */

/* @return whether a page watches now */
static bool watchers_set(struct console *k, uint64_t viewer, bool on)
{
    uint64_t *free_place = NULL;
    bool is_there = false;
    for (size_t i = 0; i < VIEWERS_MAX; i++) {
        uint64_t *w = &k->watchers[i];
        bool has_left = *w && !viewers_find(k->all->viewers, *w);
        *w = has_left || (*w == viewer && !on) ? 0 : *w;
        is_there = is_there || *w == viewer;
        free_place = *w ? free_place : w;
    }
    if (on && !is_there && free_place) {
        *free_place = viewer;
    }
    return is_watched(k);
}

static void attachment_match(struct console *k, bool watched)
{
    if (watched && !k->link.attached) {
        console_link_attach(&k->link);
    } else if (!watched && k->link.attached) {
        mu_result left = console_link_detach(&k->link, NULL);
        k->link.attached = left != MU_OK; /* no room for the mail: the next round tries again */
    }
}

enum consoles_outcome consoles_watch(struct consoles *c, const char *agent, uint64_t viewer,
                                     bool on)
{
    enum consoles_outcome ready = mu_name_valid(agent) ? agent_ready(c) : CONSOLES_NO_NAME;
    if (ready != CONSOLES_DONE) {
        return ready;
    }
    struct console *k = on ? console_for(c, agent) : console_find(c, agent);
    if (!k) {
        return on ? CONSOLES_BUSY : CONSOLES_DONE;
    }
    attachment_match(k, watchers_set(k, viewer, on));
    return CONSOLES_DONE;
}

/* --- time ------------------------------------------------------------------------------------- */

static void silence_tell(struct console *k)
{
    if (k->link.pending_count > 0 && mu_clock_ns() - k->link.heard_ns > PATIENCE_NS) {
        on_show(k, CONSOLE_NOTE, k->link.pending[0].number, "[no answer]");
        console_link_forget(&k->link);
    }
}

void consoles_round(struct consoles *c)
{
    if (c->attempt > 0 && c->state == CONSOLES_OUT) {
        agent_join(c);
    }
    for (size_t i = 0; i < CONSOLES_MAX && c->state == CONSOLES_IN; i++) {
        struct console *k = &c->all[i];
        if (k->used) {
            attachment_match(k, watchers_set(k, 0, false)); /* pages that have left */
            console_link_round(&k->link);
            silence_tell(k);
            tabs_round(k);
        }
    }
}

struct consoles *consoles_open(mu_process *process, struct viewers *viewers)
{
    struct consoles *c = mu_startup_alloc(sizeof *c);
    c->process = process;
    c->viewers = viewers;
    c->handlers = (struct mu_handlers){
        .self = c, .on_registered = on_registered, .on_mail = on_mail, .on_receipt = on_receipt};
    return c;
}

/* --- outcomes --------------------------------------------------------------------------------- */

static const struct {
    unsigned status;
    const char *text;
} outcomes[CONSOLES_OUTCOMES] = {
    [CONSOLES_DONE] = {202, ""},
    [CONSOLES_NOT_YET] = {503, "joining; try again\n"},
    [CONSOLES_NO_BROKER] = {503, "no broker is there\n"},
    [CONSOLES_NO_NAME] = {404, "that is no name of an agent\n"},
    [CONSOLES_NO_FORM] = {400, "expected whole lines of CLIPS: mind the parentheses\n"},
    [CONSOLES_MANY] = {400, "too many lines at once\n"},
    [CONSOLES_PARTLY] = {500, "not all of these lines went out: too many wait for their answers\n"},
    [CONSOLES_BUSY] = {429, "too many lines wait for their answers\n"},
    [CONSOLES_DENIED] = {403, "the broker gives this page no name\n"},
};

unsigned consoles_status(enum consoles_outcome outcome)
{
    return outcomes[outcome].status;
}

const char *consoles_text(enum consoles_outcome outcome)
{
    return outcomes[outcome].text;
}
