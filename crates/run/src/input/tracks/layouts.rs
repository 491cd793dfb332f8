//! The column layouts of public trajectory data, each as the text of `--columns`.

use super::field::Field;
use super::format::RecordingFormat;
use super::mapping::{Mapping, Origin, TrackOptions, has};
use crate::{Error, Result};

/// A layout.
pub(super) struct Layout {
    pub format: RecordingFormat,
    /// Its data sets, for messages.
    pub name: &'static str,
    /// As `--columns` has it. A file may lack all but the id, the time and the place.
    pub columns: &'static str,
    /// What x and y are.
    pub origin: Origin,
    /// Frames per second, where no file tells.
    pub frame_rate: Option<f64>,
    /// Whether y points down, as in a picture.
    pub is_picture: bool,
    /// Codes of classes.
    pub classes: &'static [(&'static str, &'static str)],
    /// Whether the classes and the frame rate are in files beside it (`00_tracks.csv`, `00_tracksMeta.csv`,
    /// `00_recordingMeta.csv`).
    pub has_meta: bool,
    /// Columns that tell road users apart whose ids are the same: its ids are used again.
    pub reused: &'static [&'static str],
}

impl Layout {
    /// That of a table with these columns: all of it but those that a file may lack. SinD and INTERACTION differ only in the
    /// name of the heading, which their files of pedestrians lack.
    pub fn known(names: &[String]) -> Option<&'static Self> {
        let fits = |layout: &&Self, is_whole: bool| {
            Mapping::parse(layout.columns).is_ok_and(|mapping| {
                let heading = Some(mapping.name(Field::Heading)).filter(|name| is_whole && !name.is_empty());
                mapping.distinctive().chain(heading).all(|name| has(names, name))
            })
        };
        let whole = LAYOUTS.iter().find(|layout| fits(layout, true));
        whole.or_else(|| LAYOUTS.iter().find(|layout| fits(layout, false)))
    }

    /// That of a format.
    pub fn of(format: RecordingFormat) -> Option<&'static Self> {
        LAYOUTS.iter().find(|layout| layout.format == format)
    }
}

/// That of a format, with what the options say instead.
///
/// # Errors
/// [`Error::Value`] where the options do not tell the columns, or say something unknown.
pub(super) fn mapping_of(format: RecordingFormat, options: &TrackOptions) -> Result<Mapping> {
    let layout = Layout::of(format);
    let columns = match (options.columns.as_str(), layout) {
        ("", None) => {
            let why = "--format table needs --columns, such as id=id,time=t,x=x,y=y";
            return Err(Error::Value(why.to_owned()));
        }
        ("", Some(layout)) => layout.columns,
        (columns, _) => columns,
    };
    let parsed = Mapping::parse(columns).map_err(|why| Error::Value(format!("--columns: {why}")))?;
    if let Some(rate) = options.frame_rate.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
        return Err(Error::Value(format!("--frame-rate is {rate}, it must be above 0")));
    }
    let base = layout.map_or(parsed.clone(), |layout| Mapping {
        origin: layout.origin,
        frame_rate: layout.frame_rate,
        is_picture: layout.is_picture,
        classes: layout.classes,
        has_meta: layout.has_meta,
        reused: layout.reused,
        ..parsed
    });
    Ok(Mapping {
        is_named: !options.columns.is_empty(),
        origin: options.origin.unwrap_or(base.origin),
        frame_rate: options.frame_rate.or(base.frame_rate),
        ..base
    })
}

/// What a table with these columns may be, as the end of a message.
pub(super) fn hint(names: &[String]) -> String {
    let layout = Layout::known(names);
    layout.map_or(String::new(), |layout| format!("; its columns are those of {}", layout.name))
}

/// In the order in which a file is compared with them.
pub(super) static LAYOUTS: [Layout; 7] = [
    Layout {
        format: RecordingFormat::InD,
        name: "inD, rounD, exiD or uniD",
        columns: "frame=frame,id=trackId,x=xCenter,y=yCenter,heading=heading[deg],vx=xVelocity,vy=yVelocity,\
                  length=length,width=width,class=class",
        origin: Origin::Centre,
        frame_rate: None,
        is_picture: false,
        classes: &[],
        has_meta: true,
        reused: &[],
    },
    Layout {
        format: RecordingFormat::HighD,
        name: "highD",
        // Its x and y are the upper left corner of a box, width is along the road and height across.
        columns: "frame=frame,id=id,x=x,y=y,vx=xVelocity,vy=yVelocity,length=width,width=height,class=class",
        origin: Origin::UpperLeft,
        frame_rate: None,
        is_picture: true,
        classes: &[],
        has_meta: true,
        reused: &[],
    },
    Layout {
        format: RecordingFormat::Ngsim,
        name: "NGSIM",
        columns: "time=Global_Time[ms],id=Vehicle_ID,x=Local_X[ft],y=Local_Y[ft],speed=v_Vel[ft/s],length=v_length[ft],\
                  width=v_Width[ft],class=v_Class",
        origin: Origin::Front,
        frame_rate: None,
        is_picture: false,
        classes: &[("1", "motorcycle"), ("2", "passenger"), ("3", "truck")],
        has_meta: false,
        reused: &["Location", "Total_Frames"],
    },
    Layout {
        format: RecordingFormat::Interaction,
        name: "INTERACTION",
        columns: "time=timestamp_ms[ms],id=track_id,class=agent_type,x=x,y=y,vx=vx,vy=vy,heading=psi_rad,\
                  length=length,width=width",
        origin: Origin::Centre,
        frame_rate: None,
        is_picture: false,
        classes: &[],
        has_meta: false,
        reused: &[],
    },
    Layout {
        format: RecordingFormat::Sind,
        name: "SinD",
        columns: "time=timestamp_ms[ms],id=track_id,class=agent_type,x=x,y=y,vx=vx,vy=vy,heading=heading_rad,\
                  length=length,width=width",
        origin: Origin::Centre,
        frame_rate: None,
        is_picture: false,
        classes: &[],
        has_meta: false,
        reused: &[],
    },
    Layout {
        format: RecordingFormat::CitySim,
        name: "CitySim",
        columns: "frame=frameNum,id=carId,x=headXft[ft],y=headYft[ft],rear_x=tailXft[ft],rear_y=tailYft[ft],\
                  speed=speed[mph]",
        origin: Origin::Front,
        frame_rate: Some(30.0),
        is_picture: true,
        classes: &[],
        has_meta: false,
        reused: &[],
    },
    Layout {
        format: RecordingFormat::OmegaPrime,
        name: "OMEGA-Prime",
        columns: "time=total_nanos[ns],id=idx,x=x,y=y,vx=vel_x,vy=vel_y,heading=yaw,length=length,width=width,class=type",
        origin: Origin::Centre,
        frame_rate: None,
        is_picture: false,
        // OSI's MovingObject.Type.
        classes: &[("1", "passenger"), ("2", "passenger"), ("3", "pedestrian"), ("4", "pedestrian")],
        has_meta: false,
        reused: &[],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layout_is_a_text_of_columns() {
        assert!(LAYOUTS.iter().all(|layout| Mapping::parse(layout.columns).is_ok()));
    }
}
