"""The viewer: a mechanism with its springs in the browser, to be moved, changed, designed again and saved.

`model` is what is shown and changed, without any widget; `scene` draws it, `panel` holds the widgets, `server` runs it.
"""
