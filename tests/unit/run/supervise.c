/* SPDX-License-Identifier: Apache-2.0 */
/* Real children, all of them /bin/sh: an absolute path stands for itself. */
#include "run/supervise.h"
#include "capture.h"
#include "core/clock.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>

enum { PATIENCE_MS = 5000 };

static struct supervise all; /* static: leak checkers see its memory */

static const struct child *first_dead(void)
{
    uint32_t i = 0;
    while (i < all.count && !supervise_has_died(&all.children[i])) {
        i++;
    }
    return i < all.count ? &all.children[i] : NULL;
}

static void set_up(void)
{
    supervise_init(&all, true, false);
    alarm(60);
}

static void tear_down(void)
{
    supervise_stop_all(&all, 1);
    alarm(0);
}

static struct child *start(const char *name, const char *script)
{
    const char *const argv[] = {"sh", "-c", script, NULL};
    CU_ASSERT_EQUAL_FATAL(supervise_start(&all, name, "/bin/sh", argv), MU_OK);
    return &all.children[all.count - 1];
}

static void nap(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
}

static uint64_t patience_end_ns(void)
{
    return mu_clock_ns() + PATIENCE_MS * 1000000ull;
}

static void await_end(const struct child *child)
{
    uint64_t until_ns = patience_end_ns();
    while (!child->ended && mu_clock_ns() < until_ns) {
        supervise_look(&all);
        nap();
    }
    CU_ASSERT_TRUE_FATAL(child->ended);
}

static void await_words(const struct child *child, const char *words)
{
    uint64_t until_ns = patience_end_ns();
    while (!strstr(child->words, words) && mu_clock_ns() < until_ns) {
        supervise_look(&all);
        nap();
    }
    CU_ASSERT_PTR_NOT_NULL_FATAL(strstr(child->words, words));
}

static void test_a_child_ends_by_itself(void)
{
    CU_ASSERT_PTR_NULL(first_dead());
    struct child *red = start("red", "echo one; echo two >&2; exit 3");
    CU_ASSERT_PTR_EQUAL(supervise_find(&all, "red"), red);
    CU_ASSERT_PTR_NULL(supervise_find(&all, "blue"));
    await_end(red);
    CU_ASSERT_PTR_EQUAL(first_dead(), red);
    CU_ASSERT(WIFEXITED(red->status) && WEXITSTATUS(red->status) == 3);
    CU_ASSERT_STRING_EQUAL(red->words, "one\ntwo\n");
    CU_ASSERT_EQUAL(red->output, -1);
    capture_begin();
    supervise_explain(red);
    capture_end();
    CU_ASSERT_STRING_EQUAL(captured,
                           "muster: red ended with exit code 3\nits last words:\none\ntwo\n");
}

static void test_a_child_is_started_again(void)
{
    struct child *red = start("red", "echo first; kill -KILL $$");
    await_end(red);
    CU_ASSERT_TRUE(supervise_has_died(red));
    pid_t first = red->pid;
    const char *const argv[] = {"sh", "-c", "echo second; sleep 60", NULL};
    CU_ASSERT_EQUAL_FATAL(supervise_start_again(&all, red, "/bin/sh", argv), MU_OK);
    CU_ASSERT_FALSE(supervise_has_died(red));
    await_words(red, "second");
    CU_ASSERT_STRING_EQUAL(red->words, "second\n");
    CU_ASSERT_NOT_EQUAL(red->pid, first);
    CU_ASSERT_PTR_EQUAL(supervise_find(&all, "red"), red);
    CU_ASSERT_EQUAL(all.count, 1);
    supervise_stop(&all, red, PATIENCE_MS);
    CU_ASSERT(WIFSIGNALED(red->status) && WTERMSIG(red->status) == SIGTERM);
}

static void test_a_killed_child_is_explained(void)
{
    struct child *red = start("red", "printf 'no end of line'; kill -SEGV $$");
    await_end(red);
    CU_ASSERT(WIFSIGNALED(red->status) && WTERMSIG(red->status) == SIGSEGV);
    capture_begin();
    supervise_explain(red);
    capture_end();
    CU_ASSERT_STRING_EQUAL(captured, "muster: red was killed by signal 11 (Segmentation fault)\n"
                                     "its last words:\nno end of line\n");
    struct child *silent = start("silent", "exit 0");
    await_end(silent);
    capture_begin();
    supervise_explain(silent);
    capture_end();
    CU_ASSERT_STRING_EQUAL(captured, "muster: silent ended with exit code 0\n");
}

static void test_output_is_passed_on_unless_quiet(void)
{
    all.quiet = false;
    capture_begin();
    struct child *red = start("red", "echo heard");
    await_end(red);
    capture_end();
    CU_ASSERT_STRING_EQUAL(captured, "heard\n");
    all.quiet = true;
    capture_begin();
    struct child *blue = start("blue", "echo silent");
    await_end(blue);
    capture_end();
    CU_ASSERT_STRING_EQUAL(captured, "");
    CU_ASSERT_STRING_EQUAL(blue->words, "silent\n");
}

/* Numbered lines of eight bytes: the last of them are kept, whole. */
static void test_limit_last_words(void)
{
    static const int counts[] = {127, 128, 129, 1000, 20000};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        char script[96];
        char want[SUPERVISE_WORDS_MAX + 16];
        size_t len = 0;
        snprintf(script, sizeof script,
                 "i=1; while [ $i -le %d ]; do printf '%%07d\\n' $i; i=$((i+1)); done", counts[i]);
        struct child *red = start("red", script);
        await_end(red);
        for (int k = counts[i] < 129 ? 1 : counts[i] - 128; k <= counts[i]; k++) {
            len += (size_t)snprintf(want + len, sizeof want - len, "%07d\n", k);
        }
        size_t cut = len > SUPERVISE_WORDS_MAX - 1 ? len - (SUPERVISE_WORDS_MAX - 1) : 0;
        CU_ASSERT_STRING_EQUAL(red->words, want + cut);
        CU_ASSERT_EQUAL(red->words_len, len - cut);
    }
}

/* What is said slowly is put together as what is said at once. */
static void test_words_that_come_in_pieces(void)
{
    struct child *red = start("red", "printf a; read x; printf b; kill $$");
    struct child *blue = start("blue", "printf 1; sleep 0.02; printf 2; sleep 0.02; printf 3");
    await_end(red); /* its standard input is empty: read fails at once */
    await_end(blue);
    CU_ASSERT_STRING_EQUAL(red->words, "ab");
    CU_ASSERT_STRING_EQUAL(blue->words, "123");
}

static void test_stop_asks_first(void)
{
    struct child *polite = start("polite", "trap 'echo bye; exit 4' TERM; echo up;"
                                           "while :; do sleep 0.01; done");
    await_words(polite, "up");
    supervise_stop(&all, polite, PATIENCE_MS);
    CU_ASSERT_TRUE_FATAL(polite->ended);
    CU_ASSERT(WIFEXITED(polite->status) && WEXITSTATUS(polite->status) == 4);
    CU_ASSERT_STRING_EQUAL(polite->words, "up\nbye\n");
    supervise_stop(&all, polite, 1); /* again: nobody is there */
}

static void test_stop_kills_in_the_end(void)
{
    struct child *stubborn =
        start("stubborn", "trap '' TERM; echo up; while :; do sleep 0.01; done");
    struct child *other = start("other", "echo up; exec sleep 60");
    await_words(stubborn, "up");
    await_words(other, "up");
    supervise_stop(&all, stubborn, 50);
    CU_ASSERT_TRUE_FATAL(stubborn->ended);
    CU_ASSERT(WIFSIGNALED(stubborn->status) && WTERMSIG(stubborn->status) == SIGKILL);
    CU_ASSERT_FALSE(other->ended);
}

static void test_stop_all(void)
{
    struct child *plain = start("plain", "echo up; exec sleep 60");
    struct child *stubborn =
        start("stubborn", "trap '' TERM; echo up; while :; do sleep 0.01; done");
    struct child *stopped = start("stopped", "echo up; kill -STOP $$; sleep 60");
    struct child *done = start("done", "exit 0");
    await_words(plain, "up");
    await_words(stubborn, "up");
    await_words(stopped, "up");
    await_end(done);
    supervise_stop_all(&all, 100);
    CU_ASSERT(plain->ended && WIFSIGNALED(plain->status) && WTERMSIG(plain->status) == SIGTERM);
    CU_ASSERT(stubborn->ended && WIFSIGNALED(stubborn->status) &&
              WTERMSIG(stubborn->status) == SIGKILL);
    CU_ASSERT(stopped->ended && WIFSIGNALED(stopped->status) &&
              WTERMSIG(stopped->status) == SIGTERM);
    CU_ASSERT(WIFEXITED(done->status));
}

static const char which_processors[] = "grep Cpus_allowed_list: /proc/self/status";

static void test_spread_children_take_turns(void)
{
    struct child *free = start("free", which_processors);
    await_end(free);
    supervise_init(&all, true, true);
    struct child *first = start("first", which_processors);
    struct child *second = start("second", which_processors);
    await_end(first);
    await_end(second);
    const char *const argv[] = {"sh", "-c", which_processors, NULL};
    CU_ASSERT_EQUAL_FATAL(supervise_start_wide(&all, "wide", "/bin/sh", argv), MU_OK);
    const struct child *wide = &all.children[all.count - 1];
    await_end(wide);
    bool many = CPU_COUNT(&all.processors) > 1;
    const struct child *const both[] = {first, second};
    for (size_t i = 0; i < 2; i++) { /* one number, no list */
        const char *list = strchr(both[i]->words, '\t');
        CU_ASSERT_PTR_NOT_NULL_FATAL(list);
        CU_ASSERT_EQUAL(list[1 + strspn(list + 1, "0123456789")], '\n');
    }
    CU_ASSERT_EQUAL(strcmp(first->words, second->words) != 0, many);
    CU_ASSERT_EQUAL(strcmp(free->words, first->words) != 0, many);
    CU_ASSERT_STRING_EQUAL(wide->words, free->words);
}

static void test_spread_without_a_known_processor(void)
{
    CPU_ZERO(&all.processors); /* as where there are too many to be asked for */
    struct child *red = start("red", "echo up");
    await_end(red);
    CU_ASSERT_STRING_EQUAL(red->words, "up\n");
}

static void test_a_program_that_is_missing(void)
{
    const char *const argv[] = {"no-such-program", NULL};
    CU_ASSERT_EQUAL(supervise_start(&all, "red", "no-such-program", argv), MU_OK);
    struct child *red = &all.children[0];
    await_end(red);
    CU_ASSERT(WIFEXITED(red->status) && WEXITSTATUS(red->status) == 127);
    CU_ASSERT_STRING_EQUAL(red->words, "cannot start: the program is missing\n");
}

static void test_limit_children(void)
{
    const char *const argv[] = {"sh", NULL};
    all.count = SUPERVISE_CHILDREN_MAX;
    CU_ASSERT_EQUAL(supervise_start(&all, "red", "/bin/sh", argv), MU_FULL);
    CU_ASSERT_EQUAL(all.count, SUPERVISE_CHILDREN_MAX);
    all.count = 0;
}

/* In a process of its own: starts a child, says its pid, and dies without a word to it. */
static _Noreturn void parent_that_crashes(int out)
{
    struct child *orphan = start("orphan", "echo up; exec sleep 60");
    await_words(orphan, "up");
    ssize_t written = write(out, &orphan->pid, sizeof orphan->pid);
    (void)written;
    kill(getpid(), SIGKILL);
    _exit(0);
}

static void test_children_die_with_their_parent(void)
{
    int ends[2];
    pid_t orphan = 0;
    int status = 0;
    prctl(PR_SET_CHILD_SUBREAPER, 1); /* the orphan comes to us */
    CU_ASSERT_EQUAL_FATAL(pipe(ends), 0);
    pid_t parent = fork();
    if (parent == 0) {
        parent_that_crashes(ends[1]);
    }
    close(ends[1]);
    CU_ASSERT_EQUAL_FATAL(read(ends[0], &orphan, sizeof orphan), sizeof orphan);
    close(ends[0]);
    CU_ASSERT_EQUAL(waitpid(parent, NULL, 0), parent);
    uint64_t until_ns = patience_end_ns();
    pid_t waited = 0;
    while (waited == 0 && mu_clock_ns() < until_ns) {
        waited = waitpid(orphan, &status, WNOHANG);
        nap();
    }
    CU_ASSERT_EQUAL(waited, orphan);
    CU_ASSERT(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    if (waited == 0) {
        kill(orphan, SIGKILL);
    }
}

/* A process that chaos has killed is no crash, and the next of its name takes its place. */
static void test_a_second_life(void)
{
    struct child *red = start("red", "sleep 60");
    struct child *blue = start("blue", "sleep 60");
    red->struck = true;
    supervise_signal(red, SIGKILL);
    await_end(red);
    CU_ASSERT_PTR_NULL(first_dead());
    (void)start("red", "echo again; exit 1");
    CU_ASSERT_EQUAL(all.count, 2);
    CU_ASSERT_PTR_EQUAL(supervise_find(&all, "red"), red);
    CU_ASSERT_FALSE(red->struck);
    await_end(red);
    CU_ASSERT_STRING_EQUAL(red->words, "again\n");
    CU_ASSERT_PTR_EQUAL(first_dead(), red);
    CU_ASSERT_FALSE(blue->ended);
}

/* Fills text with a file.  @return how long it is; -1: it is not there */
static long file_text(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "r");
    size_t len = file ? fread(text, 1, size - 1, file) : 0;
    text[len] = '\0';
    return file && fclose(file) == 0 ? (long)len : -1;
}

static struct child *start_aside(const char *name, const char *script, const char *log)
{
    const char *const argv[] = {"sh", "-c", script, NULL};
    CU_ASSERT_EQUAL_FATAL(supervise_start_aside(&all, name, "/bin/sh", argv, log), MU_OK);
    return &all.children[all.count - 1];
}

static void await_ready(const struct child *child)
{
    uint64_t until_ns = patience_end_ns();
    while (!supervise_is_ready(child) && mu_clock_ns() < until_ns) {
        supervise_look(&all);
        nap();
    }
    CU_ASSERT_TRUE_FATAL(supervise_is_ready(child));
}

static void test_who_stands_beside_has_a_log(void)
{
    char log[] = "/tmp/muster-supervise-XXXXXX", text[256];
    close(mkstemp(log));
    all.quiet = false;
    capture_begin();
    struct child *red = start_aside("red", "echo one; echo two >&2; exit 2", log);
    await_end(red);
    capture_end();
    all.quiet = true;
    CU_ASSERT_STRING_EQUAL(captured, "");
    CU_ASSERT_STRING_EQUAL(red->words, "one\ntwo\n");
    CU_ASSERT_EQUAL(file_text(log, text, sizeof text), 8);
    CU_ASSERT_STRING_EQUAL(text, "one\ntwo\n");
    struct child *plain = start("plain", "echo -$MUSTER_READY-");
    await_end(plain);
    CU_ASSERT_STRING_EQUAL(plain->words, "--\n"); /* for the others there is nothing to say */
    supervise_fate(red, text, sizeof text);
    CU_ASSERT_STRING_EQUAL(text, "ended with exit code 2");
    unlink(log);
    CU_ASSERT_EQUAL(supervise_start_aside(&all, "blue", "/bin/sh", (const char *[]){"sh", NULL},
                                          "/no/such/folder/blue.log"),
                    MU_FAULT_OS);
}

static void test_who_stands_beside_says_that_it_is_ready(void)
{
    struct child *slow =
        start_aside("slow", "while ! [ -e $0.go ]; do sleep 0.01; done", "/dev/null");
    struct child *good = start_aside("good", "echo >&$MUSTER_READY; exec sleep 60", "/dev/null");
    struct child *closes = start_aside("closes", "exec 3>&-; exec sleep 60", "/dev/null");
    struct child *dies = start_aside("dies", "exit 1", "/dev/null");
    await_ready(good);
    await_ready(closes);
    await_ready(dies);
    CU_ASSERT_FALSE(supervise_is_ready(slow));
    CU_ASSERT_FALSE(good->ended);
    CU_ASSERT_FALSE(closes->ended);
}

static void test_a_log_on_a_full_disk_ends_there(void)
{
    capture_begin();
    struct child *red = start_aside("red", "echo one; sleep 0.05; echo two", "/dev/full");
    await_end(red);
    capture_end();
    CU_ASSERT_STRING_EQUAL(captured,
                           "muster: cannot write what red says: No space left on device\n");
    CU_ASSERT_STRING_EQUAL(red->words, "one\ntwo\n");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a child ends by itself", test_a_child_ends_by_itself},
        {"a child is started again", test_a_child_is_started_again},
        {"a killed child is explained", test_a_killed_child_is_explained},
        {"output is passed on unless quiet", test_output_is_passed_on_unless_quiet},
        {"limit: last words", test_limit_last_words},
        {"words that come in pieces", test_words_that_come_in_pieces},
        {"stop asks first", test_stop_asks_first},
        {"stop kills in the end", test_stop_kills_in_the_end},
        {"stop all", test_stop_all},
        {"spread children take turns", test_spread_children_take_turns},
        {"spread without a known processor", test_spread_without_a_known_processor},
        {"a program that is missing", test_a_program_that_is_missing},
        {"limit: children", test_limit_children},
        {"children die with their parent", test_children_die_with_their_parent},
        {"a second life", test_a_second_life},
        {"a log", test_who_stands_beside_has_a_log},
        {"ready", test_who_stands_beside_says_that_it_is_ready},
        {"a log on a full disk", test_a_log_on_a_full_disk_ends_there},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"run/supervise", NULL, NULL, set_up, tear_down, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
