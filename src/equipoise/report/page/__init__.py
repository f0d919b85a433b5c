"""The report of a design: one file that says what is true of it, as a page (HTML) or printed (PDF).

- `content`: what a report is made of, free of how it looks;
- `pictures`: drawings that a page can hold, in light and dark, with texts for those who do not see them;
- `design`, `built`: the sections about the design, and about what happens to it when it is built;
- `html`, `pdf`: how it looks.
"""
