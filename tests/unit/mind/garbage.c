/* SPDX-License-Identifier: Apache-2.0 */
/* The text that minds are fed, damaged: the readers of clips_text.c end, and stay inside it. */
#include "garble.h"
#include "mind/syntax/syntax.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <float.h>
#include <stdio.h>

enum { ROUNDS = 3000, TEXT_MAX = 2048 };

static const char sample[] =
    "; rules (\n(defglobal ?*mate* = blue)\n"
    "(defrule follow \"a \\\"rule\\\"\" (goal follow)\n"
    "  (message mate-pos ?*mate* ?x&~?*y* ?y&:(> ?y 0))\n  ?f <- (mail (id ?i) (content $?c))\n"
    "  (test (neq ?x nil))\n=>\n  (bind ?*mate* [red]) (printout t \"x;)\" crlf))\n"
    "(broadcast -1.5e-3 +7 \"s\\\\\" 12345678901234567890 .5 a.b)\n";

static const char rule[] =
    "(defrule follow \"a \\\"rule\\\"\" (declare (salience ?*high*)) (goal follow)\n"
    "  (message mate-pos ?*mate* ?x&~?*y* ?y&:(> ?y ?*y*) $?z&=(+ ?*y* 1)) ; ?*mate*\n"
    "  (test (neq ?*x* nil))\n=>\n  (bind ?*mate* [red]) (printout t \"?*x;)\" crlf))\n";

static size_t damaged(struct mu_random *r, char text[TEXT_MAX])
{
    return garble(r, text, TEXT_MAX, sample, sizeof sample - 1);
}

static void test_forms(void)
{
    enum { SEED = 51 };
    struct mu_random r;
    unsigned wrong = 0;
    mu_random_seed(&r, SEED, "forms");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char text[TEXT_MAX];
        size_t len = damaged(&r, text);
        const char *at = text;
        const char *before = text;
        int line = 1;
        int lines = 1;
        for (const char *c = text; *c; c++) {
            lines += *c == '\n';
        }
        struct syntax_form f;
        while ((f = syntax_read_form(&at, &line)).kind != SYNTAX_FORM_END) {
            wrong += at > text + len || line > lines;
            if (f.kind == SYNTAX_FORM_BAD) {
                wrong += f.what == NULL;
                break;
            }
            wrong += f.at < before || f.at + f.len > at || f.len == 0;
            before = at;
        }
        (void)syntax_check(text);
    }
    CU_ASSERT_EQUAL(wrong, 0);
}

/* What was rewritten for CLIPS is printed back as it was written. */
static void test_rewriting_is_undone(void)
{
    enum { SEED = 52 };
    struct mu_random r;
    unsigned wrong = 0;
    unsigned changed = 0;
    mu_random_seed(&r, SEED, "rewrite");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char text[TEXT_MAX];
        static char rewritten[8 * TEXT_MAX];
        size_t len = garble(&r, text, sizeof text, rule, sizeof rule - 1);
        struct mu_text out;
        mu_text_init(&out, rewritten, sizeof rewritten);
        syntax_rewrite(&out, text, len);
        changed += strcmp(rewritten, text) != 0;
        syntax_as_written(rewritten);
        wrong += out.cut || strcmp(rewritten, text) != 0;
    }
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT(changed > ROUNDS / 4);
}

static void test_fields(void)
{
    enum { SEED = 53 };
    struct mu_random r;
    unsigned wrong = 0;
    mu_random_seed(&r, SEED, "fields");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char text[TEXT_MAX];
        size_t len = damaged(&r, text);
        const char *at = text;
        const char *before = text;
        struct syntax_field f;
        while ((f = syntax_read_field(&at)).kind != SYNTAX_FIELD_END &&
               f.kind != SYNTAX_FIELD_BAD) {
            bool has_text = f.kind == SYNTAX_FIELD_SYMBOL || f.kind == SYNTAX_FIELD_STRING ||
                            f.kind == SYNTAX_FIELD_INSTANCE;
            wrong += at <= before || at > text + len;
            wrong += has_text && (f.at < before || f.at + f.len > at);
            before = at;
        }
    }
    CU_ASSERT_EQUAL(wrong, 0);
}

/* A string of any bytes, quoted, reads back as that one string. */
static void test_strings_read_back(void)
{
    enum { SEED = 54 };
    struct mu_random r;
    unsigned wrong = 0;
    mu_random_seed(&r, SEED, "strings");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char text[TEXT_MAX];
        static char quoted[2 * TEXT_MAX + 3];
        char back[2 * TEXT_MAX + 3];
        (void)damaged(&r, text);
        struct mu_text out;
        mu_text_init(&out, quoted, sizeof quoted);
        syntax_add_quoted(&out, text);
        const char *at = quoted;
        struct syntax_field f = syntax_read_field(&at);
        wrong += out.cut || f.kind != SYNTAX_FIELD_STRING || *at != '\0';
        if (f.kind == SYNTAX_FIELD_STRING) {
            syntax_unescape(back, f.at, f.len);
            wrong += strcmp(back, text) != 0;
        }
    }
    CU_ASSERT_EQUAL(wrong, 0);
}

static void test_floats_and_symbols_read_back(void)
{
    enum { SEED = 55 };
    struct mu_random r;
    unsigned wrong = 0;
    mu_random_seed(&r, SEED, "floats");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char buffer[64];
        struct mu_text out;
        uint64_t bits = mu_random_next(&r);
        double x;
        memcpy(&x, &bits, sizeof x);
        if (!(x >= -DBL_MAX && x <= DBL_MAX)) {
            continue;
        }
        mu_text_init(&out, buffer, sizeof buffer);
        syntax_add_float(&out, x);
        const char *at = buffer;
        struct syntax_field f = syntax_read_field(&at);
        wrong += f.kind != SYNTAX_FIELD_FLOAT || memcmp(&f.real, &x, sizeof x) != 0 || *at != '\0';
    }
    CU_ASSERT_EQUAL(wrong, 0);
    static const char *const odd[] = {"",     "a b", "1",    "-1.5", "\"",      "(", "[a]",
                                      ";",    "?x",  "$?x",  "&",    "|",       "~", "<",
                                      "a\"b", "a;b", "\t",   "+",    "-",       "=", "1e5",
                                      ".5",   "nil", "TRUE", "a\\b", "\xc3\xa9"};
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        char buffer[64];
        struct mu_text out;
        mu_text_init(&out, buffer, sizeof buffer);
        syntax_add_symbol(&out, odd[i]);
        const char *at = buffer;
        struct syntax_field f = syntax_read_field(&at);
        char back[64] = "";
        if (f.kind == SYNTAX_FIELD_STRING) {
            syntax_unescape(back, f.at, f.len);
        } else if (f.kind == SYNTAX_FIELD_SYMBOL) {
            snprintf(back, sizeof back, "%.*s", (int)f.len, f.at);
        }
        CU_ASSERT_STRING_EQUAL(back, odd[i]);
        CU_ASSERT_EQUAL(*at, '\0');
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"forms", test_forms},
        {"rewriting is undone", test_rewriting_is_undone},
        {"fields", test_fields},
        {"strings read back", test_strings_read_back},
        {"floats and symbols read back", test_floats_and_symbols_read_back},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/garbage", tests);
}
