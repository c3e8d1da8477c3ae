"""The paper this tool grew from: what it prints, its runs, its claims, its figures, its command.

An extension: nothing outside imports it, the command line finds its command by name. A file imports only from those
above it:

    printed             what the paper prints, as data
    findings            what can come of comparing a sentence with a result
    experiments         one run of the paper's slider-crank
    reports             tables, figures and findings of one subject
    lost                what cannot be tested
    methods             Tables 1 and 2, Eqs 7 and 12 to 17
    comparison          Table 5, Fig. 9
    regions             Figs 1 to 3, introduction, sections 5.1 and 6
    slider_crank        Table 3, Fig. 4, Eqs 3 to 9 and 18 to 23
    drift               Figs 5 and 6
    influence           Table 4, Figs 7 and 8, section 4
    cost                Table 6
    ledger              all subjects in order, and every claim with what came of it
    command             the command `bezstab paper`
"""
