/* SPDX-License-Identifier: Apache-2.0 */
#include "mind/functions/table.h"

struct function_row {
    const char *name;
    int code; /* of its return type */
    void (*call)(void *env, DATA_OBJECT *out);
    const char *arguments;
    const char *usage, *text;
};

#define X(name, code, function, arguments, usage, text) \
    {name, code, function, arguments, usage, text},
static const struct function_row function_physical[] = {FUNCTIONS_PHYSICAL(X)};
static const struct function_row function_agent[] = {FUNCTIONS_AGENT(X)};
static const struct function_row function_extensions[] = {FUNCTIONS_EXTENSIONS(X)};
#undef X

static const struct {
    const char *title;
    const struct function_row *rows;
    size_t count;
} function_groups[] = {
#define GROUP(title, rows)                        \
    {                                             \
        title, rows, sizeof rows / sizeof rows[0] \
    }
    GROUP("Physical", function_physical),
    GROUP("Agent", function_agent),
    GROUP("Extensions", function_extensions),
#undef GROUP
};

enum { FUNCTION_GROUPS = sizeof function_groups / sizeof function_groups[0] };

/* Parses a call as CLIPS does for a function without a parser of its own. */
static struct expr *function_parse(void *env, struct expr *top, const char *source)
{
    const struct FunctionDefinition *f = top->value;
    top = CollectArguments(env, top, source);
    bool good = top && !CheckExpressionAgainstRestrictions(env, top, f->restrictions,
                                                           ValueToString(f->callFunctionName));
    if (top && !good) {
        ReturnExpression(env, top);
    }
    return good ? top : NULL;
}

/* Gives a function a parser that notes its calls; all else of the function stays. */
static void function_note(struct mind *m, const char *name,
                          struct expr *(*parse)(void *env, struct expr *top, const char *source))
{
    struct FunctionDefinition *f = FindFunction(m->env, name);
    MU_ASSERT(f);
    const struct FunctionDefinition before = *f;
    (void)AddFunctionParser(m->env, name, parse);
    f->restrictions = before.restrictions; /* CLIPS leaves them to the parser, */
    f->overloadable = before.overloadable; /* and allows no methods of the function */
}

/* Functions that send mail, or change groups and services, and those that call any function. */
static const char *const function_speech[] = {
    "send",       "broadcast",   "speak",      "tell",       "ask-one",    "ask-all",
    "achieve",    "reply",       "you-do",     "send-layer", "group-send", "group-create",
    "group-join", "group-leave", "advertise",  "withdraw",   "send-role",  "send-task",
    "send-near",  "reply-as",    "on-resolve", "eval",       "build",      "funcall"};

static struct expr *speech_parse(void *env, struct expr *top, const char *source)
{
    struct mind *m = environment_mind(env);
    output_of(m)->rules_speak = output_of(m)->rules_speak || ConstructData(env)->ParsingConstruct;
    return function_parse(env, top, source);
}

static void speech_install(struct mind *m)
{
    for (size_t i = 0; i < sizeof function_speech / sizeof function_speech[0]; i++) {
        function_note(m, function_speech[i], speech_parse);
    }
}

/* A plain list of the table of sensors has a function of its fact's name.  The sonars' is a row
 * above. */
static bool function_is_list(size_t number)
{
    return mu_channels[number].plain && number != MU_CHANNEL_SONAR;
}

static struct expr *sense_parse(void *env, struct expr *top, const char *source)
{
    const struct FunctionDefinition *f = top->value;
    top = function_parse(env, top, source);
    if (top) {
        sensors_note(environment_mind(env), ValueToString(f->callFunctionName));
    }
    return top;
}

static void sense_install(struct mind *m)
{
#define NOTE(id, word, ...) function_note(m, word, sense_parse);
    MU_SENSORS(NOTE)
#undef NOTE
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        if (function_is_list(i)) {
            function_note(m, mu_channels[i].fact, sense_parse);
        }
    }
    function_note(m, "clear-way", sense_parse);
}

/* One function reads all plain lists; which one is its context. */
static void lists_install(struct mind *m)
{
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        const struct mu_channel *c = &mu_channels[i];
        if (function_is_list(i)) {
            int (*call)(void *) = (int (*)(void *))(void (*)(void))sensors_list;
            int known = EnvDefineFunction2WithContext(m->env, c->fact, 'u', call, "sensors_list",
                                                      "02i", (void *)(uintptr_t)c);
            MU_ASSERT(known);
        }
    }
}

void functions_install(struct mind *m)
{
    for (size_t g = 0; g < FUNCTION_GROUPS; g++) {
        for (size_t i = 0; i < function_groups[g].count; i++) {
            const struct function_row *row = &function_groups[g].rows[i];
            int (*call)(void *) = (int (*)(void *))(void (*)(void))row->call;
            int known =
                EnvDefineFunction2(m->env, row->name, row->code, call, row->name, row->arguments);
            MU_ASSERT(known);
        }
    }
    lists_install(m);
    AddFunctionParser(m->env, "findall", query_parse);
    AddFunctionParser(m->env, "getmsg", mailbox_parse_getmsg);
    speech_install(m);
    sense_install(m);
}

/* Inside a table a bar would end the cell. */
static void function_add_cell(struct mu_text *out, const char *text)
{
    for (; *text; text++) {
        mu_text_add(out, *text == '|' ? "\\|" : (char[]){*text, '\0'});
    }
}

static void function_add_list(struct mu_text *out, const struct mu_channel *c)
{
    mu_text_format(out,
                   "| `(%s [from [to]])` | %s%s: all, those of from..to, or the one with index "
                   "from, counted from 0; what is not there is an error.  `(%s)` is `()` if the "
                   "body has none, or nothing looked at it before this step: a body reads only "
                   "what rules look at |\n",
                   c->fact, c->text, c->fields[0].unit == MU_UNIT_MM ? ", in mm" : "", c->fact);
}

void functions_page(struct mu_text *out)
{
    for (size_t g = 0; g < FUNCTION_GROUPS; g++) {
        mu_text_format(out, "%s## %s\n\n| Call | What it does and returns |\n| --- | --- |\n",
                       g ? "\n" : "", function_groups[g].title);
        for (size_t i = 0; i < function_groups[g].count; i++) {
            mu_text_add(out, "| `");
            function_add_cell(out, function_groups[g].rows[i].usage);
            mu_text_add(out, "` | ");
            function_add_cell(out, function_groups[g].rows[i].text);
            mu_text_add(out, " |\n");
        }
        for (size_t i = 0; i < MU_CHANNEL_COUNT && g == 0; i++) {
            if (function_is_list(i)) {
                function_add_list(out, &mu_channels[i]);
            }
        }
    }
}
