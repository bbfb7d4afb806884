/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a run: the whole table, what the wire says of them, and how a run goes through. */
#include "capture.h"
#include "sim/session/parts.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* A letter for each phase, in their order: gathering, ready, called, running, settling, paused
 * (while it settles), held (while it settles), ending, done, fault; '.' is a refusal. */
static const char letters[] = ".GRCrsPpHhEDF";

/* Rows: from which phase.  Columns: go, end, departure | complete, incomplete, settled, pauses,
 * holds, resumes, finishes, fails. */
static const char *const rows[] = {
    /* G */ "CE.|RG......", /* R */ "CE.|RG......", /* C */ ".E.|rC......",
    /* r */ ".Es|...PH..F", /* s */ ".Es|..rph..F", /* P */ "rE.|.....r..",
    /* p */ "sE.|.....s..", /* H */ ".Eh|.....r.F", /* h */ ".Eh|.....s.F",
    /* E */ ".EE|..EE.EDF", /* D */ "...|........", /* F */ "...|........"};

static struct session s;
static volatile sig_atomic_t signal_came;

static void set_up(void)
{
    signal_came = 0;
    s.options.signal_came = &signal_came;
    s.phase = PHASE_GATHERING;
    s.refused = 0;
}

static enum phase phase_of(char letter)
{
    return (enum phase)(strchr(letters, letter) - letters);
}

static bool aborts(enum phase_event event)
{
    int status = 0;
    capture_begin();
    pid_t child = fork();
    if (child == 0) {
        (void)phase_on(&s, event);
        _exit(0);
    }
    CU_ASSERT_EQUAL(waitpid(child, &status, 0), child);
    capture_end();
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
}

static void check(enum phase from, enum phase_event event, char wanted)
{
    bool refused = wanted == '.';
    s.phase = from;
    s.refused = 0;
    if (refused && event >= PHASE_OWN_EVENTS) {
        CU_ASSERT_TRUE(aborts(event));
        return;
    }
    capture_begin();
    CU_ASSERT_EQUAL(phase_on(&s, event), !refused);
    capture_end();
    CU_ASSERT_EQUAL(s.phase, refused ? from : phase_of(wanted));
    CU_ASSERT_EQUAL(s.refused, refused);
}

static void test_the_whole_table(void)
{
    CU_ASSERT_EQUAL(sizeof rows / sizeof rows[0], PHASES - PHASE_GATHERING);
    CU_ASSERT_EQUAL(strlen(letters), PHASES);
    for (int phase = PHASE_GATHERING; phase < PHASES; phase++) {
        const char *row = rows[phase - PHASE_GATHERING];
        CU_ASSERT_EQUAL(strlen(row), PHASE_EVENTS + 1);
        for (int event = 0; event < PHASE_EVENTS; event++) {
            check((enum phase)phase, (enum phase_event)event, row[event + (event >= 3)]);
        }
    }
}

static void test_the_words_of_the_wire(void)
{
    for (int phase = PHASE_GATHERING; phase < PHASES; phase++) {
        s.phase = (enum phase)phase;
        bool waits = phase == PHASE_GATHERING || phase == PHASE_CALLED;
        CU_ASSERT_EQUAL(phase_word(&s), waits                  ? muster_RUN_WAITING
                                        : phase == PHASE_READY ? muster_RUN_READY
                                        : phase == PHASE_DONE  ? muster_RUN_DONE
                                        : phase == PHASE_FAULT ? muster_RUN_FAULT
                                                               : muster_RUN_RUNNING);
        CU_ASSERT_EQUAL(phase_has_begun(&s), !waits && phase != PHASE_READY);
        CU_ASSERT_EQUAL(phase_is_held(&s), phase == PHASE_HELD || phase == PHASE_HELD_SETTLING);
        CU_ASSERT_EQUAL(phase_is_paused(&s),
                        phase == PHASE_PAUSED || phase == PHASE_PAUSED_SETTLING);
    }
}

static void go(enum phase_event event, enum phase wanted)
{
    CU_ASSERT_TRUE(phase_on(&s, event));
    CU_ASSERT_EQUAL(s.phase, wanted);
}

/* The word to go is said once, and may come before somebody is missing again. */
static void test_the_word_to_go_is_not_forgotten(void)
{
    go(PHASE_COMPLETE, PHASE_READY);
    go(PHASE_GO, PHASE_CALLED);
    go(PHASE_INCOMPLETE, PHASE_CALLED);
    go(PHASE_COMPLETE, PHASE_RUNNING);
}

/* A host dies while an agent moves, and another agent departs meanwhile. */
static void test_a_held_run_settles_afterwards(void)
{
    s.phase = PHASE_RUNNING;
    go(PHASE_HOLDS, PHASE_HELD);
    go(PHASE_DEPARTURE, PHASE_HELD_SETTLING);
    go(PHASE_RESUMES, PHASE_SETTLING);
    go(PHASE_SETTLED, PHASE_RUNNING);
}

static void test_a_signal_ends_it(void)
{
    CU_ASSERT_FALSE(phase_ends(&s));
    s.phase = PHASE_HELD;
    signal_came = 1;
    CU_ASSERT_TRUE(phase_ends(&s));
    CU_ASSERT_TRUE(phase_ends(&s));
    go(PHASE_FINISHES, PHASE_DONE);
    CU_ASSERT_FALSE(phase_ends(&s));
    CU_ASSERT_EQUAL(s.phase, PHASE_DONE);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the whole table", test_the_whole_table},
        {"the words of the wire", test_the_words_of_the_wire},
        {"the word to go is not forgotten", test_the_word_to_go_is_not_forgotten},
        {"a held run settles afterwards", test_a_held_run_settles_afterwards},
        {"a signal ends it", test_a_signal_ends_it},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/phase", NULL, NULL, set_up, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
