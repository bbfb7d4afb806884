/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file web.h
 * The live page of a run: its viewers, the requests that they send, and the sources of what they
 * see.
 */
#ifndef MUSTER_WEB_WEB_H
#define MUSTER_WEB_WEB_H

#include "bus/bus.h"
#include "core/json.h"
#include "core/random.h"
#include "core/text.h"
#include "muster/agent.h"
#include "muster/limits.h"
#include "muster/result.h"
#include "operator/operator.h"
#include "story/story.h"
#include "web/json.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* --- assets.c --------------------------------------------------------------------------------- */

/* The files of the page, which are part of the program: assets/, as they stand there. */

struct asset {
    const char *path; /* "/page.css" */
    const char *type; /* of its content, as HTTP names it */
    const char *bytes, *end;
};

/** @return the asset of a path, exactly; "/" is the page itself; NULL: there is none */
const struct asset *assets_find(const char *path);

/** @return the index-th asset; NULL past the last */
const struct asset *assets_at(size_t index);

/* --- browser.c -------------------------------------------------------------------------------- */

/** Opens an address in $BROWSER or by xdg-open, or says that a person has to. */
void browser_open(const char *address);

/** Takes away what browser_open left for the browser. */
void browser_close(void);

/* --- guard.c ---------------------------------------------------------------------------------- */

/*
 * Which requests the page answers, decided before anything is done about them.
 *
 * Only this machine reaches the port; what is kept out here is the rest of the browser: other sites
 * that resolve their own name to 127.0.0.1 (Host), that write to us from elsewhere (Origin,
 * Sec-Fetch-Site), and all that were not given the token, as soon as something is to be done.
 * Pure.
 */

/* Hexadecimal digits of the token: 128 bits. */
enum { GUARD_TOKEN_DIGITS = 32, GUARD_BODY_MAX = MU_CONTENT_MAX };

enum guard_verdict {
    GUARD_PASSED,
    GUARD_HOST,      /* it is for a site of another name */
    GUARD_ORIGIN,    /* a page of another site asks */
    GUARD_METHOD,    /* neither GET, HEAD nor POST, or not here */
    GUARD_PATH,      /* there is no such page */
    GUARD_TOKEN,     /* it wants to act, and has not got the token */
    GUARD_READ_ONLY, /* no page may act here */
    GUARD_SIZE,      /* more to say than a line may have */
    GUARD_VERDICTS
};

/* What a path is good for; two are for acting. */
enum guard_use { GUARD_NOTHING, GUARD_LOOK, GUARD_ACT };

/* The parts of a request that count; a header that is not there is NULL. */
struct guard_request {
    const char *method;
    enum guard_use use; /* of its path */
    const char *host;
    unsigned hosts; /* headers of that name */
    const char *origin;
    const char *site; /* Sec-Fetch-Site */
    bool is_entry;    /* the page itself, which a link elsewhere may lead to */
    const char *token;
    uint64_t body_bytes; /* that it announces, or has sent so far */
};

struct guard {
    char token[GUARD_TOKEN_DIGITS + 1];
    bool read_only;
    uint64_t refused[GUARD_VERDICTS]; /* requests, by why */
};

/** Begins with a token made of 16 random bytes. */
void guard_init(struct guard *g, const uint8_t random[GUARD_TOKEN_DIGITS / 2], bool read_only);

/** Decides, and counts what is refused. */
enum guard_verdict guard_judge(struct guard *g, const struct guard_request *r);

/** @return the HTTP status of a verdict */
unsigned guard_status(enum guard_verdict verdict);

/** @return what is wrong, as a line for people */
const char *guard_text(enum guard_verdict verdict);

/* --- target.c --------------------------------------------------------------------------------- */

/* What the path of a request asks for.  Pure. */

enum route {
    ROUTE_NONE, /* there is no such page */
    ROUTE_ASSET,
    ROUTE_EVENTS,
    ROUTE_SCENE,
    ROUTE_RECORDING,
    ROUTE_TRACKS,
    ROUTE_MOMENTS,
    ROUTE_WHY,
    ROUTE_LINES,
    ROUTE_WATCH,
    ROUTE_LEAVE,
    ROUTE_WORDS,
    ROUTE_WORLD
};

struct target {
    enum route route;
    enum guard_use use;
    const struct asset *asset; /* of ROUTE_ASSET; else NULL */
    int64_t step;              /* of ROUTE_MOMENTS and ROUTE_WHY */
    const char *name; /* of the agent that the path names, in the path; "": it names none */
};

/** Reads a path; one that is nothing here has ROUTE_NONE. */
struct target target_find(const char *path);

/* --- lobby.c ---------------------------------------------------------------------------------- */

/*
 * The connections that hold no stream: half a request, or none.
 *
 * All that come from this machine have one address.  So no limit for an address keeps a place free
 * for others: the longest waiter makes room, and none waits longer than ten seconds.
 */

enum { LOBBY_MAX = 48 };

struct lobby_place {
    int fd; /* of the connection, which the library closes */
    uint64_t since_ns;
};

struct lobby {
    struct lobby_place places[LOBBY_MAX];
    size_t count;
};

/** Notes a connection, or that it has ended a request; when all places are taken, the connection
 * that waits longest is shut down. */
void lobby_enter(struct lobby *l, int fd, uint64_t now_ns);

/** It is closed, or has a stream. */
void lobby_leave(struct lobby *l, int fd);

/** Shuts down connections that have waited too long. */
void lobby_round(struct lobby *l, uint64_t now_ns);

/* --- board.c ---------------------------------------------------------------------------------- */

/*
 * What every viewer is to see: of each sort the newest, as an event that can be sent as it stands.
 *
 * A viewer that reads slowly finds the newest when it comes back; what it has missed was replaced.
 * Pure.
 */

enum board_item {
    BOARD_RUN,        /* how far the run is, which is the broker */
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

/** Takes an event away: a page that has not seen it does not see it any more. */
void board_drop(struct board *b, enum board_item item);

/** Starts an event of any name, for one viewer: the head, and JSON behind it. */
void board_event_begin(struct mu_text *text, struct mu_json *json, const char *name);

/** Ends it, behind its JSON's last mu_json_end. */
void board_event_end(struct mu_text *text);

/* --- stream.c --------------------------------------------------------------------------------- */

/*
 * What is under way to one viewer: an event that it is reading, its own that wait, and how much of
 * the board it has seen.
 *
 * A viewer that does not read holds one event and a queue of fixed size.  The board goes on without
 * it: frames that it has missed are counted, and it is told the count.  Pure.
 */

enum { STREAM_QUEUE_BYTES = 512 * 1024 };

struct stream {
    char *event; /* being read; BOARD_EVENT_MAX bytes */
    size_t event_len, event_at;
    char *queue; /* whole events, one behind the other; STREAM_QUEUE_BYTES */
    size_t queue_len;
    uint64_t seen[BOARD_ITEMS]; /* versions that it has */
    unsigned turn;              /* item of the board that is looked at first */
    uint64_t missed;            /* frames that were replaced before it read them */
    uint64_t lost;              /* events of its own that found the queue full */
    uint64_t told;              /* missed and lost, as it was told */
};

/** Takes the memory, at start-up. */
void stream_init(struct stream *o);

/** Makes it as good as new, for another viewer. */
void stream_clear(struct stream *o);

/** Adds an event of the viewer's own.  @return MU_OK; MU_FULL: it is left out, and counted */
mu_result stream_put(struct stream *o, const struct mu_text *event);

/** @return whether there is something that it has not got */
bool stream_has(const struct stream *o, const struct board *b);

/** Hands out what comes next.  @return bytes written to buffer; 0: there is nothing now */
size_t stream_read(struct stream *o, const struct board *b, char *buffer, size_t size);

/* --- viewers.c -------------------------------------------------------------------------------- */

/* The pages that are open: each is a stream of events, with a queue of its own. */

enum { VIEWERS_MAX = 32, VIEWERS_EVENT_MAX = 128 * 1024 };

struct server;

struct viewer {
    bool used;
    uint64_t id; /* that it names itself by when it acts; never given twice */
    struct stream stream;
    struct server *server;
    void *connection; /* the server's */
    bool sleeps;      /* the server is to wake it when there is something for it */
    uint64_t sent_ns; /* when it got something last */
};

struct viewers {
    struct viewer all[VIEWERS_MAX];
    struct mu_random random; /* of ids */
    struct mu_text event;    /* one that is written for one of them */
    struct mu_json json;
    uint64_t refused; /* that found no place */
};

/** Takes the memory, at start-up.  @param seed  of the ids: random */
void viewers_init(struct viewers *v, uint64_t seed);

/** @return a new viewer; NULL: VIEWERS_MAX are there */
struct viewer *viewers_take(struct viewers *v);

void viewers_release(struct viewer *viewer);

/** @return whether another one finds a place */
bool viewers_have_room(const struct viewers *v);

/** @return the viewer, or NULL: it has left */
struct viewer *viewers_find(struct viewers *v, uint64_t id);

/** Begins an event for single viewers.  @return where its JSON goes, one object */
struct mu_json *viewers_begin(struct viewers *v, const char *name);

/** Ends the event, once, before it goes to its receivers. */
void viewers_end(struct viewers *v);

/** Puts the event into a viewer's stream; when that is full the viewer is told so later. */
void viewers_send(struct viewers *v, struct viewer *to);

/* --- consoles.c ------------------------------------------------------------------------------- */

/*
 * The consoles of all pages: lines that people type go to agents, and what agents say comes back to
 * the page that asked, or that watches.
 *
 * Until a page acts no agent joins: a page that is only looked at changes nothing in a run.  Then
 * one agent, operator-N, speaks for all pages.
 */

enum {
    CONSOLES_MAX = 48,
    CONSOLES_ASKS_MAX = CONSOLE_PENDING_MAX,
    CONSOLES_TABS_MAX = 8,   /* words that wait to be completed, of an agent */
    CONSOLES_TAB_BYTES = 128 /* of a word with the character before it */
};

/* A line that waits for its end, and the page that has asked. */
struct console_ask {
    uint64_t line;   /* 0: free */
    uint64_t viewer; /* id */
    uint64_t number; /* the viewer's own */
};

/* A word that waits for the agent's words, to be completed out of them. */
struct console_tab {
    uint64_t viewer; /* 0: free */
    uint64_t number; /* the viewer's own */
    uint64_t since_ns;
    char word[CONSOLES_TAB_BYTES]; /* the end of the line */
};

struct console {
    bool used;
    char name[MU_NAME_MAX + 1]; /* of the agent */
    struct console_link link;
    struct console_ask asks[CONSOLES_ASKS_MAX];
    struct console_tab tabs[CONSOLES_TABS_MAX];
    uint64_t watchers[VIEWERS_MAX]; /* ids; 0: free */
    uint64_t used_ns;               /* when a page did something with it last */
    struct consoles *all;
};

enum consoles_state { CONSOLES_OUT, CONSOLES_JOINING, CONSOLES_IN, CONSOLES_REFUSED };

struct consoles {
    mu_process *process;
    struct viewers *viewers;
    mu_agent *agent;
    enum consoles_state state;
    unsigned attempt; /* names that others hold */
    struct console all[CONSOLES_MAX];
    struct forms forms;
    struct mu_handlers handlers;
};

enum consoles_outcome {
    CONSOLES_DONE,
    CONSOLES_NOT_YET,   /* the agent joins just now; try again */
    CONSOLES_NO_BROKER, /* likewise, when there is one */
    CONSOLES_NO_NAME,   /* of an agent */
    CONSOLES_NO_FORM,   /* a parenthesis is open, or there is one too many */
    CONSOLES_MANY,      /* more lines at once than can ever wait */
    CONSOLES_BUSY,      /* too many lines wait, or too many consoles are open */
    CONSOLES_PARTLY,    /* the first of the lines went out; to be told, not to be tried again */
    CONSOLES_DENIED,    /* the broker gives us no name */
    CONSOLES_OUTCOMES
};

/** Takes the memory, at start-up. */
struct consoles *consoles_open(mu_process *process, struct viewers *viewers);

/**
 * Sends the forms of a text to an agent.  What it says comes to the viewer as events "said" and,
 * when nothing more comes, "ended", both with its number.
 */
enum consoles_outcome consoles_say(struct consoles *c, const char *agent, const char *text,
                                   uint64_t viewer, uint64_t number);

/**
 * Says how a line goes on: its last word is completed out of those that the agent knows.  It comes
 * to the viewer as an event "completed" with its number: rest, what belongs behind the line; and if
 * that is "", the words that it may become.
 *
 * @param line  up to the cursor
 */
enum consoles_outcome consoles_complete(struct consoles *c, const char *agent, const char *line,
                                        uint64_t viewer, uint64_t number);

/** Has a viewer shown, or no longer shown, what an agent's rules print and what is watched. */
enum consoles_outcome consoles_watch(struct consoles *c, const char *agent, uint64_t viewer,
                                     bool on);

/** After each spin of the process. */
void consoles_round(struct consoles *c);

/** @return the HTTP status that says it */
unsigned consoles_status(enum consoles_outcome outcome);

/** @return a line for people */
const char *consoles_text(enum consoles_outcome outcome);

/* --- watch.c ---------------------------------------------------------------------------------- */

/* Reads what a run tells observers, and puts it on the board. */

struct watch {
    struct board *board;
    struct bus_reader scenes, frames, statuses, brokers, beacons, whites;
    char simulator[MU_PROCESS_MAX + 1]; /* whose scene it is; "": none has come */
    uint64_t scenes_count;
    struct run_json run;
    int domain;
    struct pages *pages;
    struct mu_text totals; /* of the last frame */
    uint64_t slow_ns;      /* when what changes slowly was looked at last */
};

/** Opens the readers, and takes the memory.  @return MU_OK or a fault */
MU_MUST_USE mu_result watch_open(struct watch *w, mu_process *process, int domain,
                                 struct board *board);

/** Takes what is there. */
void watch_round(struct watch *w, uint64_t now_ns);

/* --- hands.c ---------------------------------------------------------------------------------- */

/*
 * Hands on the world, from all pages: place, push, reset, sensor and pace, as `muster world` says
 * them, at once or for later; and what became of them.
 */

enum {
    HANDS_LATER_MAX = 32, /* orders for later: as many answers in one step as the bus keeps */
    HANDS_ASKS_MAX = HANDS_LATER_MAX + 64,
    HANDS_LINE_MAX = 255,                                    /* bytes of an order */
    HANDS_TEXT_MAX = HANDS_LINE_MAX + MU_CONDITION_MAX + 64, /* with its time */
    HANDS_WORDS_MAX = 8,
    HANDS_SAID_MAX = 319
};

/* An order that the simulator has not answered yet, and the page that wants to know. */
struct hands_ask {
    uint64_t seq; /* 0: free */
    uint64_t viewer, number;
    uint64_t until_ns; /* when it is given up */
    uint64_t due_ns;   /* not before this time of the run */
    char simulator[MU_PROCESS_MAX + 1];
    char line[HANDS_LINE_MAX + 1];
    char when[MU_CONDITION_MAX + 1]; /* nor before this has come true; "": whenever */
};

struct hands {
    struct bus_writer commands;
    struct bus_reader answers;
    struct viewers *viewers;
    const struct watch *watch; /* knows the run, its simulator and the board */
    struct hands_ask asks[HANDS_ASKS_MAX];
    bool changed;                  /* what waits, since it was put on the board */
    char said[HANDS_SAID_MAX + 1]; /* why an order did not go out, as a line */
};

/** Opens reader and writer. */
MU_MUST_USE mu_result hands_open(struct hands *h, struct bus *bus, struct viewers *viewers,
                                 const struct watch *watch);

/**
 * Sends the order that a text says: a line of `muster world`, and behind it, where it is for later,
 * a line "at S", a line "when CONDITION", or both.  What becomes of it comes to all viewers as an
 * event "ordered"; to the one that has asked, with its number, to the others with 0.
 *
 * @return MU_OK; else said has why: MU_FAULT_USAGE: it is no order; MU_ABSENT: no run
 *         lives; MU_FULL: too many wait for their answers; MU_BUSY: the network does not keep up
 */
MU_MUST_USE mu_result hands_do(struct hands *h, const char *text, uint64_t viewer, uint64_t number);

/** Takes the answers that are there, gives up those that do not come, and puts the orders for later
 * that wait on the board. */
void hands_round(struct hands *h, uint64_t now_ns);

/* --- past.c ----------------------------------------------------------------------------------- */

/*
 * A recorded run, as the page reads it: any moment of it, with what was in a robot's mind, and why
 * a robot drove as it did.
 *
 * Memory is taken when it is opened, which reads the recording through once.
 */

enum {
    PAST_TEXT_MAX = 2 * 1024 * 1024, /* bytes of an answer */
    PAST_STALLS_MAX = 4096,          /* that are shown */
    PAST_LATELY_STEPS = 30,          /* so long mails are shown */
    PAST_MAILS_MAX = 200,            /* of that time, the first ones */
    PAST_PLACES_MAX = 60000          /* of all tracks together */
};

/* From the first step that found a robot stalled to the last. */
struct past_stall {
    uint32_t robot;
    int64_t from, to;
};

/* Where a robot was, whole millimetres. */
struct past_place {
    int32_t x_mm, y_mm;
};

/* Where all robots were: each step, or of a long recording each second, third, ... one. */
struct past_tracks {
    size_t robots, every;
    int64_t *steps;            /* of rows */
    struct past_place *places; /* row by row, the robots in the order of the Scene */
    size_t rows, rows_max;
};

struct past {
    struct recording recording;
    struct past_stall stalls[PAST_STALLS_MAX];
    size_t stalls_count;
    size_t stalls_last[MU_ROBOTS_MAX]; /* of each robot: its last one's index, and 1; 0: none */
    uint64_t stalls_lost;              /* that found no room */
    struct past_tracks tracks;
    struct mu_text text; /* the last answer */
    const char *name;    /* of the file */
};

/** Opens a recording.  @return MU_OK; MU_FAULT_FILE */
MU_MUST_USE mu_result past_open(struct past *p, const char *path, struct mu_fault *fault);

/** Puts its scene on the board. */
void past_show(const struct past *p, struct board *board);

/**
 * Writes what there is:
 *
 *     name, first, last (steps), step_ms
 *     robots    those that have a diary
 *     stalls    [robot's index, first step, last step], ...
 *
 * @return the text, good until the next question
 */
const struct mu_text *past_whole(struct past *p);

/**
 * Writes where robots were:
 *
 *     steps     those of the places
 *     robots    of each [x, y, x, y, ...], whole millimetres
 *
 * @return the text, good until the next question; NULL: it is too long
 */
const struct mu_text *past_tracks(struct past *p);

/**
 * Writes the moment at the end of a step, or of the last one before it that there is:
 *
 *     frame       as frame_json.c has it
 *     statistics  as frame_json_totals
 *     lately      [step, from, to, performative, content], ...    mails of the steps before it
 *     mind        as mind_json.c has it, if one was asked for
 *
 * @param robot  whose mind; "": none
 * @return the text, good until the next question; NULL: there is no step at all, or it is too long
 */
const struct mu_text *past_moment(struct past *p, int64_t step, const char *robot);

/**
 * Writes why a robot's motors did what they did at a step, as indented lines.
 *
 * @return the text, good until the next question; NULL: it has no diary
 */
const struct mu_text *past_why(struct past *p, int64_t step, const char *robot);

void past_close(struct past *p);

/* --- server.c --------------------------------------------------------------------------------- */

/*
 * The HTTP side: libmicrohttpd on 127.0.0.1, in our loop and thread.
 *
 *     GET  / and the other assets
 *     GET  /events       the stream of events of one viewer; HEAD: whether there is room for one
 *     GET  /scene        the world
 *     GET  /recording    what recording is shown; null: a run is
 *     GET  /tracks       where robots were in it
 *     GET  /moments/STEP[/NAME]    a moment of it, and what was in that robot's mind
 *     GET  /why/STEP/NAME          why that robot drove as it did
 *     POST /lines/NAME   a text of CLIPS to an agent
 *     POST /words/NAME   how this line goes on: its last word is to be completed
 *     POST /watch/NAME   show me what its rules print and what is watched
 *     POST /leave/NAME   no longer
 *     POST /world        an order to the world: place red 1 2; in lines behind it: at S, when
 * CONDITION
 *
 * A POST needs X-Muster-Token, and says by X-Muster-Viewer and X-Muster-Ask which page asks and
 * what it calls the question.  The library parses, limits and answers; it allocates on its own.
 */

struct server;

struct server_parts {
    struct guard *guard;
    struct board *board;
    struct viewers *viewers;
    struct consoles *consoles; /* NULL: no page acts here */
    struct hands *hands;       /* likewise */
    struct past *past;         /* NULL: no recording */
    int domain;
};

/**
 * Listens.
 *
 * @param port  0: any free one
 * @return MU_OK; MU_BUSY: the port is taken; MU_FAULT_OS
 */
MU_MUST_USE mu_result server_open(struct server **out, const struct server_parts *parts,
                                  uint16_t port);

/** @return the port that it listens on */
uint16_t server_port(const struct server *s);

/** @return a descriptor that is readable when server_run has something to do */
int server_fd(const struct server *s);

/** @return so long at most until server_run is due, ms; < 0: no limit */
int server_timeout_ms(const struct server *s);

/** Handles what is there: requests, and what viewers have not got yet.  Never blocks. */
void server_run(struct server *s, uint64_t now_ns);

void server_close(struct server *s);

#endif
