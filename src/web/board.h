/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file board.h
 * What every viewer is to see: of each sort the newest, as an event that can be sent as it stands.
 *
 * A viewer that reads slowly finds the newest when it comes back; what it has missed was replaced.
 * Pure.
 */
#ifndef MUSTER_WEB_BOARD_H
#define MUSTER_WEB_BOARD_H

#include "core/json.h"
#include "core/text.h"

enum board_item {
    BOARD_RUN,        /* how far the run is, who is the broker */
    BOARD_SCENE,      /* that there is another scene */
    BOARD_FRAME,      /* one step */
    BOARD_STATISTICS, /* totals since the run began */
    BOARD_AGENTS,     /* the white pages */
    BOARD_LATER,      /* orders from pages that wait for their time */
    BOARD_ITEMS
};

enum {
    BOARD_EVENT_MAX = 1024 * 1024,    /* bytes of one event */
    BOARD_SCENE_MAX = 8 * 1024 * 1024 /* bytes of a scene, which viewers fetch */
};

struct board_event {
    struct mu_text text; /* "event: frame\ndata: {...}\n\n"; "": there is none now */
    uint64_t version;    /* 0: there was none yet */
};

struct board {
    struct board_event items[BOARD_ITEMS];
    struct mu_text scene; /* JSON; "": none */
    struct mu_text draft; /* an event that is being written */
    struct mu_json json;  /* into it */
    enum board_item item; /* that it is */
    uint64_t cut;         /* events that were too long, and left out */
};

/** Takes the board's memory, at start-up. */
void board_init(struct board *b);

/** Begins an event.  @return where its JSON goes, one object */
struct mu_json *board_begin(struct board *b, enum board_item item);

/* What became of an event. */
enum board_ended {
    BOARD_NEW,  /* it has taken the place of the one before */
    BOARD_SAME, /* as the one before */
    BOARD_CUT   /* too long, and left out: the one before stands */
};

/** Ends it. */
enum board_ended board_end(struct board *b);

/** Takes an event away: who has not seen it does not see it any more. */
void board_drop(struct board *b, enum board_item item);

/** Starts an event of any name, for one viewer: the head, and JSON behind it. */
void board_event_begin(struct mu_text *text, struct mu_json *json, const char *name);

/** Ends it, behind its JSON's last mu_json_end. */
void board_event_end(struct mu_text *text);

#endif
