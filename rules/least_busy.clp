; SPDX-License-Identifier: Apache-2.0
;
; A resolver of addresses in rules: least-busy:2 stands for the two workers with the least to do.
; worker.clp and customer.clp are its team.
;
; It counts what it has given away, as two mails may come before a worker has said a word.

(deftemplate worker
  (slot name)
  (slot load))  ; jobs that it has, or is about to get

; Workers that were there before it, or before it died without a checkpoint.
(defrule call-the-roll
  (event on-run)
  =>
  (broadcast roll-call))

(defrule hear-load
  (declare (salience 10))
  ?mail <- (mail (from ?who) (content load ?load))
  =>
  (retract ?mail)
  (do-for-all-facts ((?w worker)) (eq ?w:name ?who)
    (retract ?w))
  (assert (worker (name ?who) (load ?load))))

(defrule hear-done
  (declare (salience 10))
  ?mail <- (mail (from ?who) (content done))
  ?worker <- (worker (name ?who) (load ?load))
  =>
  (retract ?mail)
  (modify ?worker (load (max 0 (- ?load 1)))))

; The order is by load, then by name: nothing else may decide.
(deffunction busier (?a ?b)
  (bind ?more (- (fact-slot-value ?a load) (fact-slot-value ?b load)))
  (or (> ?more 0)
      (and (= ?more 0)
           (> (str-compare (fact-slot-value ?a name) (fact-slot-value ?b name)) 0))))

; What stands behind the colon is how many are wanted.  FALSE: there is no such address.
(deffunction least-busy (?count ?sender)
  (if (not (and (integerp ?count) (> ?count 0))) then
    (return FALSE))
  (bind ?workers (sort busier (find-all-facts ((?w worker)) (neq ?w:name ?sender))))
  (bind ?chosen (create$))
  (loop-for-count (?i 1 (min ?count (length$ ?workers)))
    (bind ?worker (nth$ ?i ?workers))
    (bind ?chosen (create$ ?chosen (fact-slot-value ?worker name)))
    (modify ?worker (load (+ 1 (fact-slot-value ?worker load)))))
  ?chosen)

(on-resolve least-busy least-busy)
