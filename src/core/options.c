/* SPDX-License-Identifier: Apache-2.0 */
#include "core/options.h"

#include "core/spell.h"
#include "core/text.h"
#include "muster/version.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What every program understands beside its own table. */
static const struct mu_option options_common[] = {
    {.name = "config",
     .kind = MU_OPTION_STRING,
     .unit = "FILE",
     .help = "configuration file (else $MUSTER_CONFIG, else ~/.config/muster/config)"},
    {.name = "help", .letter = 'h', .kind = MU_OPTION_FLAG, .help = "print this text"},
    {.name = "version", .kind = MU_OPTION_FLAG, .help = "print the version"},
};
enum { OPTIONS_COMMON_COUNT = sizeof options_common / sizeof options_common[0] };

/* For programs that read the table; people have --help. */
static const char dump_name[] = "dump-options";

/* The command line while it is read. */
struct options_reader {
    struct mu_options *options;
    char **argv;
    int argc;
    int at;
    const char *config; /* --config FILE */
    bool help, version, dump;
};

static mu_result options_wrong(const struct mu_options *o)
{
    fprintf(stderr, "try '%s --help'\n", o->program);
    return MU_FAULT_USAGE;
}

static const struct mu_option *options_find_common(const char *name)
{
    for (size_t i = 0; i < OPTIONS_COMMON_COUNT; i++) {
        if (strcmp(options_common[i].name, name) == 0) {
            return &options_common[i];
        }
    }
    return NULL;
}

static mu_result options_unknown(const struct mu_options *o, const char *argument, const char *name)
{
    char shown[MU_TEXT_SHOWN];
    struct mu_spell spell;
    mu_spell_init(&spell, name);
    for (size_t i = 0; i < o->count; i++) {
        mu_spell_offer(&spell, o->table[i].name);
    }
    fprintf(stderr, "%s: unknown option '%s'", o->program, mu_text_show(shown, argument));
    if (spell.nearest) {
        fprintf(stderr, "; did you mean '--%s'?\n", spell.nearest);
    } else {
        fprintf(stderr, "; ");
    }
    return options_wrong(o);
}

static mu_result options_take(struct options_reader *r, struct mu_option *option, const char *value)
{
    char why[MU_OPTION_WHY_MAX], shown[MU_TEXT_SHOWN];
    if (option->kind == MU_OPTION_LIST && option->source != MU_OPTION_COMMAND_LINE) {
        ((struct mu_option_list *)option->target)->count = 0;
    }
    option->source = MU_OPTION_COMMAND_LINE;
    option->place[0] = '\0';
    if (!mu_option_set(option, value, why)) {
        fprintf(stderr, "%s: --%s %s: %s\n", r->options->program, option->name,
                mu_text_show(shown, value), why);
        return options_wrong(r->options);
    }
    return MU_OK;
}

/* @param value  the text behind "=" or a letter; NULL: none */
static mu_result options_take_value(struct options_reader *r, struct mu_option *option,
                                    const char *value)
{
    if (option->kind == MU_OPTION_FLAG) {
        return options_take(r, option, value ? value : "yes");
    }
    bool follows = r->at < r->argc && !(option->alone && r->argv[r->at][0] == '-');
    if (!value && follows) {
        value = r->argv[r->at++];
    }
    value = value ? value : option->alone;
    if (!value) {
        fprintf(stderr, "%s: --%s needs a value: --%s %s\n", r->options->program, option->name,
                option->name, option->unit ? option->unit : "VALUE");
        return options_wrong(r->options);
    }
    return options_take(r, option, value);
}

static mu_result options_take_common(struct options_reader *r, const struct mu_option *common,
                                     const char *value)
{
    struct mu_option option = *common;
    option.target = common == &options_common[0]   ? (void *)&r->config
                    : common == &options_common[1] ? (void *)&r->help
                                                   : (void *)&r->version;
    return options_take_value(r, &option, value);
}

static mu_result options_read_long(struct options_reader *r, const char *argument)
{
    char name[64];
    const char *equals = strchr(argument, '=');
    size_t len = equals ? (size_t)(equals - argument) - 2 : strlen(argument) - 2;
    struct mu_text text = mu_text_in(name, sizeof name);
    mu_text_add_bytes(&text, argument + 2, len);
    const char *value = equals ? equals + 1 : NULL;

    struct mu_option *option = mu_options_find(r->options, name);
    if (option) {
        return options_take_value(r, option, value);
    }
    const struct mu_option *common = options_find_common(name);
    if (common) {
        return options_take_common(r, common, value);
    }
    if (strcmp(argument + 2, dump_name) == 0) {
        r->dump = true;
        return MU_OK;
    }
    option = strncmp(name, "no-", 3) == 0 ? mu_options_find(r->options, name + 3) : NULL;
    if (option && option->kind == MU_OPTION_FLAG && !value) {
        return options_take(r, option, "no");
    }
    return options_unknown(r->options, argument, name);
}

static struct mu_option *options_find_letter(const struct mu_options *o, char letter)
{
    for (size_t i = 0; i < o->count; i++) {
        if (o->table[i].letter == letter) {
            return &o->table[i];
        }
    }
    return NULL;
}

/* Letters may share one dash: -qs 5, -s5. */
static mu_result options_read_letters(struct options_reader *r, const char *argument)
{
    for (const char *letter = argument + 1; *letter; letter++) {
        if (*letter == 'h' && !options_find_letter(r->options, 'h')) {
            r->help = true;
            continue;
        }
        struct mu_option *option = options_find_letter(r->options, *letter);
        if (!option) {
            char shown[MU_TEXT_SHOWN];
            fprintf(stderr, "%s: unknown option '-%s'; ", r->options->program,
                    mu_text_show(shown, (char[]){*letter, '\0'}));
            return options_wrong(r->options);
        }
        bool last = option->kind != MU_OPTION_FLAG;
        mu_result taken = options_take_value(r, option, last && letter[1] ? letter + 1 : NULL);
        if (taken != MU_OK || last) {
            return taken;
        }
    }
    return MU_OK;
}

/* A dash alone, and a negative number, are words. */
static bool options_is_word(const char *argument)
{
    return argument[0] != '-' || argument[1] == '\0' || isdigit((unsigned char)argument[1]) ||
           argument[1] == '.';
}

static mu_result options_read_word(struct mu_options *o, const char *word)
{
    if (o->no_words) {
        char shown[MU_TEXT_SHOWN];
        fprintf(stderr, "%s: expected options alone, not '%s'; ", o->program,
                mu_text_show(shown, word));
        return options_wrong(o);
    }
    if (o->words_count == MU_OPTION_WORDS_MAX) {
        fprintf(stderr, "%s: more than %d words; ", o->program, MU_OPTION_WORDS_MAX);
        return options_wrong(o);
    }
    o->words[o->words_count++] = word;
    return MU_OK;
}

static mu_result options_read_line(struct options_reader *r)
{
    bool ended = false;
    while (r->at < r->argc) {
        const char *argument = r->argv[r->at++];
        mu_result read = MU_OK;
        if (!ended && strcmp(argument, "--") == 0) {
            ended = true;
        } else if (ended || options_is_word(argument)) {
            read = options_read_word(r->options, argument);
        } else if (argument[1] == '-') {
            read = options_read_long(r, argument);
        } else {
            read = options_read_letters(r, argument);
        }
        if (read != MU_OK) {
            return read;
        }
    }
    return MU_OK;
}

static void options_set_defaults(struct mu_options *o)
{
    char why[MU_OPTION_WHY_MAX];
    o->words_count = 0;
    for (size_t i = 0; i < o->count; i++) {
        struct mu_option *option = &o->table[i];
        option->source = MU_OPTION_DEFAULT;
        option->place[0] = '\0';
        if (option->kind == MU_OPTION_LIST) {
            ((struct mu_option_list *)option->target)->count = 0;
        }
        if (option->fallback) {
            MU_ASSERT(mu_option_set(option, option->fallback, why));
        }
    }
}

static mu_result options_read_environment(struct mu_options *o)
{
    char why[MU_OPTION_WHY_MAX], shown[MU_TEXT_SHOWN];
    for (size_t i = 0; i < o->count; i++) {
        struct mu_option *option = &o->table[i];
        const char *value = option->environment ? getenv(option->environment) : NULL;
        if (!value || !value[0] || option->source == MU_OPTION_COMMAND_LINE) {
            continue;
        }
        if (!mu_option_set(option, value, why)) {
            fprintf(stderr, "%s: environment variable %s=%s: %s\n", o->program, option->environment,
                    mu_text_show(shown, value), why);
            return options_wrong(o);
        }
        option->source = MU_OPTION_ENVIRONMENT;
        mu_text_copy(option->place, sizeof option->place, option->environment);
    }
    return MU_OK;
}

static void options_dump_row(const struct mu_option *option)
{
    char letter[2] = {option->letter, '\0'};
    const char *unit = option->kind == MU_OPTION_FLAG ? "" : option->unit ? option->unit : "VALUE";
    printf("%s\t%s\t%s\t%s\t%s\t%s\t%s\n", option->name, letter, unit,
           option->kind == MU_OPTION_LIST ? "many" : "", option->fallback ? option->fallback : "",
           option->environment ? option->environment : "", option->help);
}

static void options_dump(const struct mu_options *options)
{
    for (size_t i = 0; i < options->count; i++) {
        options_dump_row(&options->table[i]);
    }
    for (size_t i = 0; i < OPTIONS_COMMON_COUNT; i++) {
        options_dump_row(&options_common[i]);
    }
}

/* @return whether the program has no more to do than what was printed */
static bool options_print(const struct options_reader *r)
{
    if (r->dump) {
        options_dump(r->options);
    } else if (r->help) {
        mu_options_print_help(r->options);
    } else if (r->version) {
        printf("%s %s\n", r->options->program, MU_VERSION);
    }
    return r->dump || r->help || r->version;
}

mu_result mu_options_parse(struct mu_options *options, int argc, char **argv)
{
    struct options_reader r = {.options = options, .argv = argv, .argc = argc, .at = 1};
    options_set_defaults(options);
    mu_result result = options_read_line(&r);
    if (result != MU_OK) {
        return result;
    }
    if (options_print(&r)) {
        return MU_DONE;
    }
    result = mu_options_read_config(options, r.config);
    result = result == MU_OK ? options_read_environment(options) : result;
    if (result == MU_OK && options->one && options->words_count != 1) {
        fprintf(stderr, "%s: name one %s, for example: %s %s\n", options->program, options->one,
                options->program, options->example);
        return MU_FAULT_USAGE;
    }
    return result;
}

static void options_print_row(const struct mu_option *option)
{
    char left[80], letter[8] = "    ";
    if (option->letter) {
        snprintf(letter, sizeof letter, "-%c, ", option->letter);
    }
    bool flag = option->kind == MU_OPTION_FLAG;
    snprintf(left, sizeof left, "%s--%s%s%s", letter, option->name, flag ? "" : " ",
             flag ? "" : (option->unit ? option->unit : "VALUE"));
    printf(strlen(left) > 26 ? "  %s\n%30s%s" : "  %-26s%s%s", left, strlen(left) > 26 ? "" : "  ",
           option->help);
    bool off = flag && option->fallback && strcmp(option->fallback, "no") == 0;
    if (option->fallback && option->fallback[0] && !off) {
        printf(" (default: %s)", option->fallback);
    }
    if (option->environment) {
        printf(" [%s]", option->environment);
    }
    printf("\n");
}

void mu_options_print_help(const struct mu_options *options)
{
    printf("usage: %s %s\n\n%s\n\noptions:\n", options->program, options->usage, options->about);
    for (size_t i = 0; i < options->count; i++) {
        options_print_row(&options->table[i]);
    }
    for (size_t i = 0; i < OPTIONS_COMMON_COUNT; i++) {
        options_print_row(&options_common[i]);
    }
    printf("\nA value comes from the flag, else from [the environment], else from the "
           "configuration file, else it is the default.\n");
}
