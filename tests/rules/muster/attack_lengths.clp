; SPDX-License-Identifier: Apache-2.0
; options: library=no
; Functions of the engine that go through all bytes or fields of huge arguments: they are paid for
; in ticks, and what cannot be paid is not done.
(defglobal ?*s* = "" ?*t* = "" ?*f* = (create$) ?*n* = 0)
(deffunction text (?of ?times) (bind ?s ?of) (loop-for-count ?times do (bind ?s (str-cat ?s ?s))) ?s)
(deffunction fields (?of ?times) (bind ?f (create$ ?of)) (loop-for-count ?times do (bind ?f (create$ ?f ?f))) ?f)

; line: (progn (bind ?*s* (text a 23)) (str-length ?*s*))
; expect: 8388608
; line: (progn (bind ?*t* (str-cat (text a 22) b)) (str-length ?*t*))
; expect: 4194305
; line: (str-index ?*t* ?*s*)
; expect: FALSE
; line: (str-index "b" (str-cat (sub-string 1 1000 ?*s*) b))
; expect: 1001
; line: (progn (bind ?*s* "") (bind ?*t* "") (bind ?*f* (fields a 18)) (length$ ?*f*))
; expect: 262144
; line: (member$ b ?*f*)
; expect: FALSE
; line: (subsetp (create$ ?*f* b) (create$ ?*f*))
; expect: FALSE
; expect: stopped: the guard for ticks
; expect: refused
; line: (member$ (create$ (subseq$ ?*f* 1 100000) b) ?*f*)
; expect: FALSE
; expect: stopped: the guard for ticks
; expect: refused
; line: (progn (bind ?*n* 0) (sort > (fields 1 18)) (length$ ?*f*))
; expect: FALSE
; expect: stopped: the guard for ticks
; expect: refused
; line: (loop-for-count 1000000 do (member$ b ?*f*))
; expect: FALSE
; expect: stopped: the guard for ticks
; expect: refused
; line: (sort > 3 1 2)
; expect: (1 2 3)
