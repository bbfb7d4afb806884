; SPDX-License-Identifier: Apache-2.0
; What functions of the engine that are ours do, with more of everything than a robot has.

;;; many facts are there once each
(deffunction fill (?from ?to ?by)
  (bind ?new 0)
  (loop-for-count (?i ?from ?to)
    (if (assert (number (* ?i ?by) (sym-cat n ?i) "text" (+ ?i 0.5))) then (bind ?new (+ ?new 1))))
  ?new)
(defrule r => (printout t (fill 1 3000 1) " " (fill 1 3000 1) " " (fill 2000 4000 1) crlf)
  (printout t (length$ (find-all-facts ((?f number)) (> (nth$ 1 ?f:implied) 3990))) crlf)
  (do-for-all-facts ((?f number)) (evenp (nth$ 1 ?f:implied)) (retract ?f))
  (printout t (fill 1 10 1) " " (fill 1 10 1.0) " " (fill 1 10 1.0) crlf))

;;; all gone and there again
(deffunction fill (?n) (loop-for-count (?i 1 ?n) (assert (reading ?i (/ ?i 7)))))
(deffunction empty () (do-for-all-facts ((?f reading)) TRUE (retract ?f)))
(defrule r => (loop-for-count 3 (fill 500) (empty))
  (fill 300) (retract *)
  (printout t (any-factp ((?f reading)) TRUE) " " (assert (reading 1 2)) (assert (reading 1 2)) crlf))

;;; modified into what is there
(deftemplate p (slot a) (multislot b))
(deffacts f (p (a 1) (b x 1.5)) (p (a 2) (b x 1.5)))
(defrule r ?p <- (p (a 2)) => (printout t (modify ?p (a 1)) crlf) (facts))

;;; duplicates when they may be
(defrule r => (set-fact-duplication TRUE) (assert (a 1) (a 1)) (assert (a 1))
  (printout t (length$ (find-all-facts ((?f a)) TRUE)) crlf)
  (do-for-fact ((?f a)) TRUE (retract ?f))
  (printout t (length$ (find-all-facts ((?f a)) TRUE)) crlf))

;;; zeros
(defrule r => (printout t (assert (z 0.0)) (assert (z -0.0)) (assert (z 0)) (assert (z (- 0 0.0))) crlf)
  (printout t (eq 0.0 -0.0) (= 0.0 -0.0) (eq (* -1 0.0) -0.0) crlf))

;;; no numbers
(defrule r => (bind ?inf (* 1e200 1e200)) (bind ?nan (- ?inf ?inf))
  (printout t ?inf " " (eq ?nan ?nan) " " (eq ?inf (* 2 ?inf)) crlf)
  (printout t (assert (a ?inf)) (assert (a ?inf)) crlf))

;;; ends of whole numbers
(defrule r => (bind ?least -9223372036854775807)
  (printout t (- ?least 1) " " (+ 9223372036854775807 0) " " (eq (- ?least 1) (- ?least 1)) crlf)
  (assert (n (- ?least 1)) (n ?least) (n 9223372036854775807)))
(defrule s (n ?n) (n ?m&~?n) => (printout t ?n " " ?m crlf))

;;; numbers by the thousand
(deffunction sums (?n)
  (bind ?sum 0.0)
  (loop-for-count (?i 1 ?n) (bind ?sum (+ ?sum (sqrt ?i) (/ 1 ?i))))
  ?sum)
(defrule r => (printout t (sums 20000) " " (sums 20000) crlf))

;;; words by the thousand
(deffunction words (?n)
  (bind ?all (create$))
  (loop-for-count (?i 1 ?n) (bind ?all (create$ ?all (sym-cat w- (mod (* ?i 7919) 1009) -x))))
  ?all)
(defrule r => (bind ?w (words 1500))
  (printout t (length$ ?w) " " (nth$ 1500 ?w) " " (member$ w-7-x ?w) " " (eq (nth$ 1 ?w) (nth$ 1010 ?w)) crlf))

;;; joins on numbers
(deffacts f (a 1.5 x) (a 2.5 y) (a -0.125 z) (b 2.5 p) (b 1.5 q) (b 1.5 r) (b 7 s))
(defrule join (a ?n ?x) (b ?n ?y) => (printout t ?n ?x ?y crlf))
(defrule lonely (b ?n ?y) (not (a ?n ?)) => (printout t lonely ?n ?y crlf))
(defrule r => (assert (a 7 t)) (assert (b -0.125 u)))

;;; values of every kind
(defclass THING (is-a USER) (slot s))
(deftemplate held (slot v) (multislot m))
(defrule r => (bind ?i (make-instance thing of THING (s 2.5)))
  (bind ?f (assert (a b)))
  (assert (held (v ?f) (m ?i [thing] "s" s 1 1.0 ?f)))
  (assert (held (v ?f) (m ?i [thing] "s" s 1 1.0 ?f)))
  (facts))
(defrule again ?h <- (held (v ?f) (m $? "s" ?s $?)) => (retract ?f ?h) (printout t ?s crlf))

;;; pieces of every size come and go
(deffunction list-of (?n ?x) (bind ?all (create$))
  (loop-for-count ?n (bind ?all (create$ ?all ?x))) ?all)
(deffunction text-of (?n) (bind ?text "") (loop-for-count ?n (bind ?text (str-cat ?text "t"))) ?text)
(deffunction fill (?from ?to ?by)
  (loop-for-count (?i ?from ?to)
    (assert (piece (* ?i ?by) (text-of (* ?i ?by)) (list-of ?i (sym-cat s ?i))))))
(deffunction sum () (bind ?sum 0)
  (do-for-all-facts ((?f piece)) TRUE
    (bind ?sum (+ ?sum (length$ ?f:implied) (str-length (nth$ 2 ?f:implied))))) ?sum)
(defrule r => (fill 1 60 10) (printout t (sum))
  (do-for-all-facts ((?f piece)) (evenp (nth$ 1 ?f:implied)) (retract ?f))
  (fill 20 70 9) (printout t " " (sum))
  (do-for-all-facts ((?f piece)) (> (nth$ 1 ?f:implied) 300) (retract ?f))
  (fill 1 60 11) (printout t " " (sum) crlf))
