"""Bad inputs, kills, full disks, many writers: every command answers in one clear line and loses nothing."""
