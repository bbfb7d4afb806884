/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include "core/text.h"
#include "muster/memory.h"
#include "operator/operator.h"
#include "runtime/process.h"
#include "web/json.h"

#include <string.h>

/* What people read as words and numbers need not change more often. */
static const uint64_t SLOW_NS = 250000000;

mu_result watch_open(struct watch *w, mu_process *process, int domain, struct board *board)
{
    struct bus *bus = &process->bus;
    *w = (struct watch){
        .board = board, .domain = domain, .pages = mu_startup_alloc(sizeof *w->pages)};
    pages_init(w->pages);
    mu_text_init(&w->totals, mu_startup_alloc(BOARD_EVENT_MAX), BOARD_EVENT_MAX);
    MU_TRY(bus_reader_open(bus, BUS_SCENE, NULL, &w->scenes));
    MU_TRY(bus_reader_open(bus, BUS_FRAME, "latest", &w->frames));
    MU_TRY(bus_reader_open(bus, BUS_RUN_STATUS, NULL, &w->statuses));
    MU_TRY(bus_reader_open(bus, BUS_BROKER_STATUS, NULL, &w->brokers));
    MU_TRY(bus_reader_open(bus, BUS_BEACON, NULL, &w->beacons));
    MU_TRY(bus_reader_open(bus, BUS_PAGES, NULL, &w->whites));
    return MU_OK;
}

/* --- what changes with each step -------------------------------------------------------------- */

/* Viewers are told that there is another one, and fetch it: it may be large.  The last frame of the
 * run before is of no use with it. */
static void scene_put(struct watch *w, const muster_Scene *scene)
{
    mu_text_copy(w->simulator, sizeof w->simulator, scene->simulator);
    run_json_begin(&w->run);
    board_drop(w->board, BOARD_FRAME);
    board_drop(w->board, BOARD_STATISTICS);
    mu_text_clear(&w->totals);
    scene_json_write(&w->board->scene, scene);
    if (w->board->scene.cut) {
        w->board->cut++;
        mu_text_clear(&w->board->scene);
    }
    struct mu_json *j = board_begin(w->board, BOARD_SCENE);
    mu_json_object(j, NULL);
    mu_json_uint(j, "number", ++w->scenes_count);
    mu_json_end(j);
    (void)board_end(w->board);
}

static void scenes_take(struct watch *w)
{
    enum bus_life life;
    const muster_Scene *scene;
    while ((scene = bus_next(&w->scenes, &life))) {
        if (life == BUS_DATA) {
            scene_put(w, scene);
        }
    }
}

static void frame_put(struct watch *w, const muster_Frame *frame)
{
    struct mu_json totals;
    frame_json_write(board_begin(w->board, BOARD_FRAME), NULL, frame, false);
    if (board_end(w->board) == BOARD_CUT) { /* beams are most of it */
        frame_json_write(board_begin(w->board, BOARD_FRAME), NULL, frame, true);
        (void)board_end(w->board);
    }
    mu_text_clear(&w->totals);
    mu_json_to_text(&totals, &w->totals, MU_JSON_LINE);
    frame_json_totals(&totals, NULL, frame);
}

/* A frame is of use only with its scene. */
static void frames_take(struct watch *w)
{
    enum bus_life life;
    const muster_Frame *frame;
    while ((frame = bus_next(&w->frames, &life))) {
        if (life == BUS_DATA && strcmp(frame->simulator, w->simulator) == 0) {
            frame_put(w, frame);
        }
    }
}

/* --- what changes slowly ---------------------------------------------------------------------- */

static void statuses_take(struct watch *w)
{
    enum bus_life life;
    const muster_RunStatus *status;
    while ((status = bus_next(&w->statuses, &life))) {
        if (life == BUS_DATA) {
            run_json_take(&w->run, status);
        } else {
            run_json_lose(&w->run, status->simulator);
        }
    }
}

static void brokers_take(struct watch *w)
{
    enum bus_life life;
    const muster_BrokerStatus *b;
    while ((b = bus_next(&w->brokers, &life))) {
        if (life == BUS_DATA) {
            run_json_mails(&w->run, b);
        }
    }
}

static void beacons_take(struct watch *w)
{
    enum bus_life life;
    const muster_Beacon *b;
    while ((b = bus_next(&w->beacons, &life))) {
        run_json_broker(&w->run, b->broker, life == BUS_DATA);
    }
}

static void pages_read(struct watch *w)
{
    enum bus_life life;
    const muster_Page *page;
    while ((page = bus_next(&w->whites, &life))) {
        const muster_Page gone = {.broker = page->broker, .part = page->part};
        pages_take(w->pages, life == BUS_DATA ? page : &gone);
    }
}

/* A run on this machine has noted where its report is to be. */
static void report_find(struct watch *w)
{
    char folder[sizeof w->run.report];
    if (run_json_has_ended(&w->run) && !w->run.report[0] &&
        runs_folder_of(w->domain, folder, sizeof folder)) {
        mu_text_copy(w->run.report, sizeof w->run.report, folder);
    }
}

static void slow_put(struct watch *w)
{
    report_find(w);
    run_json_write(board_begin(w->board, BOARD_RUN), &w->run);
    (void)board_end(w->board);
    pages_write(board_begin(w->board, BOARD_AGENTS), w->pages);
    (void)board_end(w->board);
    if (w->totals.len > 0) {
        (void)board_begin(w->board, BOARD_STATISTICS);
        mu_text_add(&w->board->draft, w->totals.at);
        (void)board_end(w->board);
    }
}

void watch_round(struct watch *w, uint64_t now_ns)
{
    scenes_take(w);
    frames_take(w);
    statuses_take(w);
    brokers_take(w);
    beacons_take(w);
    pages_read(w);
    if (now_ns - w->slow_ns >= SLOW_NS) {
        w->slow_ns = now_ns;
        slow_put(w);
    }
}
