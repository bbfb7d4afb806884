; SPDX-License-Identifier: Apache-2.0
;
; What a monitor sees of a run (docs/monitors.md): `muster monitor` loads this before its rules.
; In each step these facts stand anew; mm, mm/s, degrees, seconds.

(deftemplate step
  (slot number)
  (slot time)
  (slot missed)               ; steps that were not seen just before this one
  (slot world) (slot seed))

(deftemplate robot
  (slot name)
  (slot state)                ; standby, running, suspended, moving, absent
  (slot x) (slot y) (slot heading)
  (slot speed) (slot turn-rate)
  (slot command-speed) (slot command-turn-rate)
  (slot stalled)              ; TRUE or FALSE
  ; since the start:
  (slot distance) (slot stalls) (slot stalled-time)
  (slot mean-speed) (slot efficiency)
  (slot sent) (slot received) (slot fired)
  (slot explored)             ; share of the floor, 0 to 1; -1: not known
  (slot nearest)              ; who came nearest, or nil,
  (slot nearest-distance) (slot nearest-time)
  (slot goal-time) (slot at-goal)) ; nil without a goal

(deftemplate agent            ; of the run, without a body
  (slot name) (slot state)
  (slot sent) (slot received) (slot fired))

(deftemplate team
  (slot distance) (slot stalls) (slot explored) (slot most-efficient)
  (slot sent) (slot received) (slot fired))

(deftemplate thing               ; that can be moved: CLIPS keeps the word object for itself
  (slot name) (slot x) (slot y) (slot heading))

(deftemplate mail-seen        ; of this step; (fired NAME RULE) likewise
  (slot from) (slot to) (slot performative) (slot language)
  (slot conversation)         ; nil without one
  (slot outside)              ; TRUE: from outside the run
  (multislot content))

(deftemplate run-ended        ; once, and rules fire a last time
  (slot how)                  ; done, fault, lost
  (slot step) (slot time) (slot hash))
