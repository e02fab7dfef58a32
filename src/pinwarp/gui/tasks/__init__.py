"""Work off the UI thread, and questions to the user."""
