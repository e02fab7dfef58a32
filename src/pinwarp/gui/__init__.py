"""The window: the only place that knows Qt, PyVista's plotting and VTK's rendering."""
